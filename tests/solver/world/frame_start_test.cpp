// A frame of one implicit step is restored from what that step holds, not from a copy: positions and velocities before it, and
// the trial points.
#include "scenarios/towers.h"
#include "scenarios/walls.h"
#include "solver/world/checkpoint.h"
#include "solver/world/engine.h"
#include "solver/world/simulation.h"
#include "tests/support/block_scenes.h"
#include "tests/support/prepare_and_step.h"

#include <algorithm>
#include <cstdint>
#include <gtest/gtest.h>
#include <ostream>
#include <string>

namespace springtower {
namespace {

struct Island {
  const char* name;
  Scene scene;
};

void PrintTo(const Island& tested, std::ostream* stream) {
  *stream << tested.name;
}

class FrameStartTest : public ::testing::TestWithParam<Island> {};

void expectHeldByTheStep(const Simulation& simulation) {
  const std::vector<FrameStartIn>& in = simulation.engine->checkpoint.in;
  EXPECT_TRUE(std::all_of(in.begin(), in.end(), [](FrameStartIn where) { return where == FrameStartIn::step; }));
}

TEST_P(FrameStartTest, OfAFrameOfOneStepIsRestored) {
  Simulation simulation(awake(GetParam().scene));
  stepFor(simulation, 0.5);
  // Something small moves, so that the step is one of Newton's iteration and changes positions, velocities and points.
  for (std::size_t c = 0; c < kCorners; ++c) simulation.state.velocity.add(0, c, Vec3(1e-6, 0.0, 0.0));
  const std::uint64_t before = stateHash(simulation);
  const std::uint64_t steps = simulation.counters.implicitSteps;
  prepareAndStep(simulation);
  ASSERT_EQ(simulation.counters.implicitSteps, steps + 1);
  EXPECT_NE(stateHash(simulation), before);
  expectHeldByTheStep(simulation);
  restoreFrame(simulation);
  EXPECT_EQ(stateHash(simulation), before);
}

// The points of a pair that is saved after the step, as one is whose manifold is refreshed, are those of the frame's start too.
TEST_P(FrameStartTest, OfAPairThatIsSavedAfterTheStepIsRestored) {
  Simulation simulation(awake(GetParam().scene));
  stepFor(simulation, 0.5);
  for (std::size_t c = 0; c < kCorners; ++c) simulation.state.velocity.add(0, c, Vec3(1e-6, 0.0, 0.0));
  const std::uint64_t before = stateHash(simulation);
  prepareAndStep(simulation);
  expectHeldByTheStep(simulation);
  Engine& engine = *simulation.engine;
  for (std::size_t at = 0; at < engine.pairs.size(); at += 3) {
    savePair(engine, at);
    if (!engine.pairs.touches(at)) continue;
    for (PointRow* row : engine.contacts.points(engine.pairs.contact[at])) {
      if (row != nullptr) row->penalty.maxwellDepth.fill(1.0);
    }
  }
  restoreFrame(simulation);
  EXPECT_EQ(stateHash(simulation), before);
}

// Narrow islands, those whose kernels run in one call, and those that run in ranges, in some of whose pairs eight points touch.
INSTANTIATE_TEST_SUITE_P(Of, FrameStartTest,
                         ::testing::Values(Island{"Tower6", towerScene(6)}, Island{"Wall12x8", wallScene(12, 8)},
                                           Island{"Wall24x16", wallScene(24, 16)}),
                         [](const auto& tested) { return std::string(tested.param.name); });

}  // namespace
}  // namespace springtower
