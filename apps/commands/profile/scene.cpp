#include "apps/commands/profile/scene.h"

#include "core/error.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <fmt/format.h>
#include <numbers>

namespace springtower {
namespace {

constexpr double kTowerSpacing_m = 0.3;
constexpr double kCollapseTilt_deg = 14.5;  // a tower of 18 rows topples, but does not slide
constexpr double kSway_deg = 0.1;
constexpr double kSway_hz = 1.0;
constexpr double kProfileHeightsSigma_m = 0.0002;
constexpr double kPullSpeed_m_s = 0.04;
constexpr double kPullStart_m = 0.001;  // from here on the block slides
constexpr double kPullLongest_s = 5.0;
constexpr double kAsleepLongest_s = 60.0;
constexpr double kStrongest_n = 100.0;
constexpr int kPileCells = 6;        // of three blocks side by side, along and across
constexpr double kPileGap = 0.002;   // between blocks of a row, in their lengths
constexpr double kPileFall_m = 0.1;  // what it has fallen through when it lands

// The middle block of the middle row.
int pulledBlock(const Scene& scene, int rows) {
  const auto found = std::find_if(scene.blocks.begin(), scene.blocks.end(),
                                  [&](const BlockSpec& block) { return block.row == rows / 2 && block.position == 2; });
  return static_cast<int>(found - scene.blocks.begin());
}

bool isPull(ProfileScene scene) {
  return scene == ProfileScene::pull || scene == ProfileScene::pullSleep;
}

bool allAsleep(const Simulation& simulation) {
  return std::all_of(simulation.asleep.begin(), simulation.asleep.end(), [](std::uint8_t flag) { return flag != 0; });
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
  while (scene.simulation.time_s < seconds && !deadline.passed()) scene.step();
}

void fallAsleep(PreparedScene& scene, const Deadline& deadline) {
  while (!allAsleep(scene.simulation)) {
    if (deadline.passed() || scene.simulation.time_s > kAsleepLongest_s) {
      scene.failure = fmt::format("not asleep after {:.1f} s simulated", scene.simulation.time_s);
      return;
    }
    scene.step();
  }
}

// A stack of square rows, each turned by a right angle against the one below and shifted by half a block, so that all of it is
// connected. Nothing holds its blocks together but their weight.
void layPile(int rows, Scene& scene) {
  const BlockSpec first = scene.blocks.front();
  const double length = (1.0 + kPileGap) * first.dimensions.x();
  const double width = length / 3.0;
  scene.blocks.clear();
  for (int row = 0; row < rows; ++row) {
    const bool turned = row % 2 == 1;
    const double shift = turned ? 0.5 * length : 0.0;
    for (int i = 0; i < kPileCells * kPileCells * 3; ++i) {
      const int line = i / (3 * kPileCells);
      const double along = (line + 0.5) * length + shift;
      const double across = (i - 3 * kPileCells * line + 0.5) * width + shift;
      BlockSpec block = first;
      block.row = row;
      block.centre = Vec3(turned ? across : along, turned ? along : across, (row + 0.5) * first.dimensions.z());
      block.orientation = Eigen::AngleAxisd(turned ? 0.5 * std::numbers::pi : 0.0, Vec3::UnitZ());
      block.velocity = -std::sqrt(2.0 * scene.gravity.magnitude * kPileFall_m) * Vec3::UnitZ();
      scene.blocks.push_back(block);
    }
  }
  scene.name = fmt::format("a pile of {} blocks", scene.blocks.size());
}

// Pulls until the block slides, so that every timed frame has a moving block.
void startPulling(PreparedScene& scene, int rows, const Deadline& deadline) {
  Simulation& simulation = scene.simulation;
  const auto block = static_cast<std::size_t>(pulledBlock(simulation.scene, rows));
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
    scene.step();
  }
}

}  // namespace

void PreparedScene::step() {
  const BlockId held = hand.hand.block;
  if (held != kFloor) advancePull(hand, contactForcesOn(simulation, held), simulation);
  stepFrame(simulation);
}

Scene sceneOf(const ProfileCase& what) {
  TowerOptions options;
  if (what.scene == ProfileScene::heights) options.heightsSigma_m = kProfileHeightsSigma_m;
  Scene scene = towerScene(what.rows, options);
  if (what.towers > 1) {
    const Scene tower = scene;
    const int side = static_cast<int>(std::ceil(std::sqrt(static_cast<double>(what.towers))));
    scene.blocks.clear();
    for (int i = 0; i < what.towers; ++i) {
      const int line = i / side;
      for (BlockSpec block : tower.blocks) {
        block.centre += kTowerSpacing_m * Vec3(i - line * side, line, 0.0);
        scene.blocks.push_back(block);
      }
    }
    scene.name = fmt::format("{} towers of {} rows", what.towers, what.rows);
  }
  if (what.scene == ProfileScene::pile) layPile(what.rows, scene);
  if (what.scene == ProfileScene::collapse) scene.gravity.tilt_deg = kCollapseTilt_deg;
  if (what.scene == ProfileScene::sway) {
    scene.gravity.sway_deg = kSway_deg;
    scene.gravity.sway_hz = kSway_hz;
  }
  Settings& settings = scene.settings;
  settings.method = what.method;
  settings.inertia = what.inertia;
  settings.tolerance_m = what.tolerance_m;
  const bool sleeps = what.scene == ProfileScene::asleep || what.scene == ProfileScene::pullSleep;
  settings.sleep = sleeps ? Sleep::on : Sleep::off;
  return scene;
}

std::unique_ptr<PreparedScene> prepareScene(const ProfileCase& what, const ProfileLimits& limits) {
  auto scene = std::make_unique<PreparedScene>(what);
  // None of a pile's blocks has a place to keep.
  if (what.scene == ProfileScene::pile) scene->leftOut.assign(scene->simulation.scene.blocks.size(), 1);
  const Deadline deadline(limits.prepare_s);
  try {
    if (what.scene == ProfileScene::asleep) {
      fallAsleep(*scene, deadline);
    } else if (what.scene == ProfileScene::collapse) {
      scene->step();  // it looks for the equilibrium that the tower starts from: that is loading
    } else if (what.scene != ProfileScene::pile) {
      settle(*scene, limits.settle_s, deadline);
    }
    if (isPull(what.scene)) startPulling(*scene, what.rows, Deadline(limits.prepare_s));
  } catch (const DivergenceError& error) {
    scene->failure = error.what();
  }
  scene->snapshot = takeSnapshot(scene->simulation);
  scene->handKept = scene->hand;
  return scene;
}

}  // namespace springtower
