// Number of implicit steps a frame as a function of the vibration.

#include "solver/implicit/step_count.h"

#include "core/scene/scene.h"
#include "solver/contact/query.h"
#include "solver/implicit/run.h"
#include "solver/world/island_step.h"
#include "solver/world/simulation.h"
#include "tests/support/block_scenes.h"

#include <cmath>
#include <gtest/gtest.h>
#include <vector>

namespace springtower {
namespace {

// A block in the air, with synthetic steps.
struct VibratingBlock {
  VibratingBlock() {
    step.drift_s = 0.25 * simulation.scene.settings.frame_s;
    step.gravity = simulation.scene.gravity.at(0.0);
  }

  BlockHistory& history() { return simulation.engine->memo.blockHistory[0]; }

  // A step that ends at time `end_s` of a vibration of angular frequency `omega` along x.
  void swing(double omega, double end_s) {
    const double h = step.drift_s;
    const auto speed = [&](double time_s) { return 0.01 * std::cos(omega * time_s); };
    note(speed(end_s - 2.0 * h), speed(end_s - h), speed(end_s));
  }

  // A step under an acceleration along x.
  void push(double acceleration_m_s2) {
    const Engine& engine = *simulation.engine;
    const double before = simulation.state.velocity.values(0, 0)[0];
    note(engine.memo.previousVelocity.values(0, 0)[0], before, before + acceleration_m_s2 * step.drift_s);
  }

  // A step in which the velocity along x changes from `before` to `now`, after one that started at `first`.
  void note(double first, double before, double now) {
    Engine& engine = *simulation.engine;
    const double h = step.drift_s;
    const double effective_s = kBdf2 * h;
    const double last = before - first;
    for (std::size_t c = 0; c < kCorners; ++c) {
      simulation.state.velocity.values(0, 0)[c] = now;
      engine.memo.previousVelocity.values(0, 0)[c] = before;
      for (std::size_t a = 0; a < 3; ++a) {
        const double speed = engine.memo.previousVelocity.values(a, 0)[c];
        const double change = a == 0 ? last : 0.0;
        engine.scratch.pastPosition.values(a, 0)[c] = 0.1;
        engine.scratch.freePosition.values(a, 0)[c] =
            0.1 + effective_s * (speed + change / 3.0) + effective_s * effective_s * step.gravity[static_cast<Eigen::Index>(a)];
      }
    }
    history().lastImplicitStep_s = h;
    updateFrequencyEstimate(step, effective_s);
  }

  static Scene scene() {
    Scene scene = oneBlockScene(false);
    scene.settings.method = Method::implicit;
    return scene;
  }

  Simulation simulation{scene()};
  std::vector<std::int32_t> blocks{0};
  std::vector<std::int32_t> pairs;
  Counters counters;
  StageTimes times;
  IslandStep step{simulation, *simulation.engine, blocks, pairs, counters, times, contactLaw(simulation)};
};

// Means over some frames fluctuate about the exact value during a period: by a few hundredths here.
TEST(FrequencyEstimate, MatchesTheFrequencyOfAVibration) {
  for (const double omega : {40.0, 80.0}) {
    VibratingBlock block;
    for (int i = 0; i < 240; ++i) {
      block.swing(omega, (i + 1) * block.step.drift_s);
      if (i < 120) continue;
      EXPECT_NEAR(std::sqrt(std::sqrt(block.history().jerk / block.history().motion)), omega, 0.05 * omega) << "step " << i;
    }
  }
}

// A frame of n steps damps a vibration by (w T)^4 / (4 n^3), of which a 150th is allowed: n = cbrt(37.5 (w T)^4), rounded up.
TEST(FrequencyEstimate, DeterminesTheStepCount) {
  VibratingBlock block;
  const double frame_s = block.simulation.scene.settings.frame_s;
  const auto stepsAt = [&](double turn, int present) {
    block.history().motion = 1.0;
    block.history().jerk = std::pow(turn / frame_s, 4.0);
    return stepsForFrequency(block.step, present);
  };
  EXPECT_EQ(stepsAt(0.1, 1), 1);
  EXPECT_EQ(stepsAt(0.6, 1), 2);   // 1.69
  EXPECT_EQ(stepsAt(1.0, 1), 4);   // 3.35
  EXPECT_EQ(stepsAt(1.4, 1), 6);   // 5.24
  EXPECT_EQ(stepsAt(10.0, 1), 8);  // 72, of which there are at most 8
  EXPECT_EQ(stepsAt(1.0, 5), 5) << "half as much damping would need 4.2, so five steps stay five";
  EXPECT_EQ(stepsAt(0.6, 5), 3) << "but not where they are more than that";
}

// A force that jumps at each frame, like a user's, in one of eight steps: the finer the steps, the higher the apparent frequency;
// the step count decreases nevertheless.
TEST(FrequencyEstimate, JumpsOfTheForceDoNotKeepTheStepsFine) {
  constexpr int kSteps = 8;
  VibratingBlock block;
  block.step.drift_s = block.simulation.scene.settings.frame_s / kSteps;
  for (int frame = 0; frame < 60; ++frame) {
    for (int i = 0; i < kSteps; ++i) block.push(frame % 2 == 0 ? 2.0 : -2.0);
  }
  EXPECT_LE(stepsForFrequency(block.step, kSteps), kSteps / 2 + 1);
}

TEST(FrequencyEstimate, IgnoresAQuiescentBlock) {
  VibratingBlock block;
  const double frame_s = block.simulation.scene.settings.frame_s;
  const double calm = quiescentSpeed(block.simulation);
  const auto stepsAt = [&](double speed) {
    block.history().motion = block.simulation.model.mass[0] * static_cast<double>(kCorners) * speed * speed;
    block.history().jerk = std::pow(2.0 / frame_s, 4.0) * block.history().motion;
    return stepsForFrequency(block.step, 1);
  };
  EXPECT_EQ(stepsAt(10.0 * calm), 8);
  EXPECT_EQ(stepsAt(0.01 * calm), 1);
}

}  // namespace
}  // namespace springtower
