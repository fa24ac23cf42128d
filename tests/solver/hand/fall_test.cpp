#include "scenarios/towers.h"
#include "solver/hand/grip.h"
#include "solver/metrics/measures.h"
#include "solver/world/engine.h"
#include "tests/support/prepare_and_step.h"

#include <gtest/gtest.h>

namespace springtower {
namespace {

constexpr double kTilt_deg = 20.0;
constexpr int kFallFrames = 60;

// Blocks that are in rigid steps, and those of them that have fallen.
struct Falling {
  int rigid = 0;
  int fallen = 0;
};
Falling fallingNow(const Simulation& simulation) {
  Falling now;
  for (std::size_t b = 0; b < simulation.scene.blocks.size(); ++b) {
    if (!simulation.engine->memo.islandHistory[b].rigid) continue;
    ++now.rigid;
    now.fallen += simulation.engine->memo.blockHistory[b].hasFallen ? 1 : 0;
  }
  return now;
}

// A tower of 18 rows topples away from a hand that holds the middle block of its lowest row. When rigid steps take it, as most of
// its mass is faster than 0.45 sqrt(g h), these blocks count as fallen: it is no stack that stands.
TEST(FallUnderAHand, WhatFallsHasFallenThoughAHandHoldsABlock) {
  Scene scene = leaning(towerScene(18), kTilt_deg);
  scene.settings.sleep = Sleep::off;
  Simulation simulation(scene);
  Grip grip;
  Hand hand;
  hand.block = blockId(1);
  hand.place = scene.blocks[1].centre;
  hand.turn = scene.blocks[1].orientation;
  Falling now;
  for (int frame = 0; frame < kFallFrames && now.rigid < 40; ++frame) {
    hold(hand, contactForces(simulation), grip, simulation);
    prepareAndStep(simulation);
    now = fallingNow(simulation);
  }
  ASSERT_GE(now.rigid, 40);
  EXPECT_GT(2 * now.fallen, now.rigid - 1) << "of those that no hand holds";
  EXPECT_FALSE(simulation.engine->memo.blockHistory[1].hasFallen) << "the hand holds it";
}

}  // namespace
}  // namespace springtower
