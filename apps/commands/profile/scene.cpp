#include "apps/commands/profile/scene.h"

#include "apps/commands/profile/falls.h"
#include "apps/commands/profile/stacks.h"
#include "apps/common/interruption.h"
#include "apps/common/prepare_or_end.h"
#include "core/error.h"
#include "core/processor_time.h"
#include "core/rotation_vector.h"
#include "scenarios/recorded/recorded_game.h"
#include "scenarios/towers.h"
#include "scenarios/walls.h"
#include "solver/hand/played_frame.h"

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <fmt/format.h>
#include <numbers>
#include <utility>

namespace springtower {
namespace {

constexpr double kSway_deg = 0.1;
constexpr double kSway_hz = 1.0;
constexpr double kPullSpeed_m_s = 0.04;
constexpr double kPullStart_m = 0.001;  // from here on the block slides
constexpr double kPullLongest_s = 5.0;
constexpr double kAsleepLongest_s = 60.0;
constexpr double kStrongest_n = 100.0;

bool isPull(ProfileScene scene) {
  return scene == ProfileScene::pull || scene == ProfileScene::pullSleep;
}

// Wall time that preparing may take.
class Deadline {
 public:
  explicit Deadline(double seconds)
      : end_(Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds))) {}
  [[nodiscard]] bool passed() const { return Clock::now() >= end_; }

 private:
  using Clock = std::chrono::steady_clock;
  Clock::time_point end_;
};

void settle(PreparedScene& scene, double seconds, const Deadline& deadline) {
  while (scene.simulation.time_s < seconds && !deadline.passed()) {
    endIfInterrupted();
    scene.step();
  }
}

void fallAsleep(PreparedScene& scene, const Deadline& deadline) {
  while (!allAsleep(scene.simulation)) {
    if (deadline.passed() || scene.simulation.time_s > kAsleepLongest_s) {
      scene.failure = fmt::format("not asleep after {:.1f} s simulated", scene.simulation.time_s);
      return;
    }
    endIfInterrupted();
    scene.step();
  }
}

// A pile instead of the scene's blocks. A profile counts its rows, whose compression it measures.
void layPile(int rows, Scene& scene) {
  const Eigen::Quaterniond turn = rotationAbout(Vec3::UnitZ(), 0.5 * std::numbers::pi);
  scene.blocks = pileScene(rows, {.fall_m = kPileFall_m, .turn = turn}).blocks;
  for (std::size_t b = 0; b < scene.blocks.size(); ++b) scene.blocks[b].row = static_cast<int>(b) / kPileRowBlocks;
  scene.name = fmt::format("a pile of {} blocks", scene.blocks.size());
}

// Pulls until the block slides, so that every timed frame has a moving block.
void startPulling(PreparedScene& scene, const Deadline& deadline) {
  Simulation& simulation = scene.simulation;
  const auto block = middleBlock(simulation.scene);
  const Vec3 direction = simulation.scene.blocks[block].orientation * Vec3::UnitX();
  scene.hand = drawingFrom(simulation, blockId(block), direction, kPullSpeed_m_s, kStrongest_n);
  scene.leftOut.assign(simulation.scene.blocks.size(), 0);
  scene.leftOut[block] = 1;
  const Vec3 start = centre(simulation.state.position, block);
  while ((centre(simulation.state.position, block) - start).dot(direction) < kPullStart_m) {
    if (deadline.passed() || scene.hand.drawn_s > kPullLongest_s) {
      scene.failure = fmt::format("the block does not slide yet after {:.2f} s of pulling, now with {:.2f} N", scene.hand.drawn_s,
                                  gripForce(simulation).force.norm());
      return;
    }
    endIfInterrupted();
    scene.step();
  }
}

// The blocks, and how gravity acts on them.
Scene blocksOf(const ProfileCase& what) {
  if (isStack(what.scene)) return stackScene(what.named);
  if (isFall(what.scene)) return fallScene(what.named);
  if (what.scene == ProfileScene::game) return recordedTower();
  TowerOptions options;
  if (what.scene == ProfileScene::heights) options.heightsSigma_m = kUnevenHeightsSigma_m;
  Scene scene = towerScene(what.rows, options);
  if (what.towers > 1) {
    scene = squareOf(std::move(scene), what.towers);
    scene.name = fmt::format("{} towers of {} rows", what.towers, what.rows);
  }
  if (what.scene == ProfileScene::pile) layPile(what.rows, scene);
  if (what.scene == ProfileScene::collapse)
    scene = leaning(std::move(scene), std::max(kTopplingTilt_deg, collapseTilt_deg(what.rows)));
  if (what.scene == ProfileScene::sway) scene = swaying(std::move(scene), kSway_deg, kSway_hz);
  return scene;
}

}  // namespace

void PreparedScene::restore() {
  restoreSnapshot(simulation, *snapshot);
  hand = handKept;
  if (game == nullptr) return;
  grip = {};  // a game is kept as it begins
  contacts = contactForces(simulation);
}

void PreparedScene::step() {
  if (game != nullptr) {
    const bool goesOn = simulation.frame < game->frames.size();
    stepPlayed(goesOn ? game->frames[simulation.frame].input.hand : Hand{}, grip, contacts, simulation);
    return;
  }
  prepareOrEnd(simulation);
  const BlockId held = hand.hand.block;
  if (held != kFloor) advancePull(hand, contactForcesOn(simulation, held), simulation);
  stepFrame(simulation);
}

Scene sceneOf(const ProfileCase& what) {
  Scene scene = blocksOf(what);
  Settings& settings = scene.settings;
  settings.method = what.method;
  settings.inertia = what.inertia;
  settings.tolerance_m = what.tolerance_m;
  if (what.scene == ProfileScene::game) return scene;  // it sleeps as it was played
  const bool sleeps = what.scene == ProfileScene::asleep || what.scene == ProfileScene::pullSleep;
  settings.sleep = sleeps ? Sleep::on : Sleep::off;
  return scene;
}

std::unique_ptr<PreparedScene> prepareScene(const ProfileCase& what, const ProfileLimits& limits) {
  auto scene = std::make_unique<PreparedScene>(what);
  if (what.scene == ProfileScene::game) scene->game = &recordedGame();
  // None of what falls has a place to keep.
  if (what.scene == ProfileScene::pile || what.scene == ProfileScene::game || isFall(what.scene))
    scene->leftOut.assign(scene->simulation.scene.blocks.size(), 1);
  try {
    if (isStack(what.scene)) {
      scene->equilibrium_s = prepareOrEnd(scene->simulation).processor_s;  // it may take longer than all else
    }
    const Deadline deadline(limits.prepare_s);
    if (what.scene == ProfileScene::asleep) {
      fallAsleep(*scene, deadline);
    } else if (what.scene == ProfileScene::game) {
      prepareOrEnd(scene->simulation);
    } else if (what.scene == ProfileScene::collapse || isFall(what.scene)) {
      prepareOrEnd(scene->simulation);
      scene->step();
    } else if (what.scene != ProfileScene::pile) {
      settle(*scene, limits.settle_s, deadline);
    }
    if (isPull(what.scene)) startPulling(*scene, Deadline(limits.prepare_s));
  } catch (const DivergenceError& error) {
    scene->failure = error.what();
  }
  scene->snapshot = takeSnapshot(scene->simulation);
  scene->handKept = scene->hand;
  return scene;
}

}  // namespace springtower
