#include "solver/runner/run.h"

#include "core/scene/scene.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>

namespace springtower {
namespace {

TEST(Quantile, IsByNearestRank) {
  EXPECT_EQ(quantile({}, 0.5), 0.0);
  EXPECT_EQ(quantile({7.0}, 0.01), 7.0);
  EXPECT_EQ(quantile({3.0, 1.0, 2.0}, 0.5), 2.0);
  EXPECT_EQ(quantile({4.0, 3.0, 1.0, 2.0}, 0.5), 2.0);
  std::vector<double> hundred;
  for (int i = 100; i > 0; --i) hundred.push_back(i);
  EXPECT_EQ(quantile(hundred, 0.99), 99.0);
  EXPECT_EQ(quantile(hundred, 1.0), 100.0);
}

// A lone block on the floor, or falling from above it.
Scene blockAt(double height) {
  Scene scene;
  BlockSpec block;
  block.centre.z() = 0.5 * kBlockHeight_m + height;
  scene.blocks = {block};
  scene.name = "a block";
  return scene;
}

TEST(RunScene, CallsBackAtTheStartAndAfterEveryFrame) {
  Simulation simulation(blockAt(0.0));
  RunOptions options;
  options.seconds = 0.5;
  std::vector<double> times;
  const RunResult result = runScene(simulation, options, [&](const Simulation& now) { times.push_back(now.time_s); });
  ASSERT_EQ(times.size(), 31U);
  for (std::size_t i = 0; i < times.size(); ++i) EXPECT_NEAR(times[i], static_cast<double>(i) / 60.0, 1e-12);
  EXPECT_EQ(result.frames, 30U);
  EXPECT_EQ(result.counters.frames, 30U);
  EXPECT_NEAR(result.simulated_s, 0.5, 1e-12);
  EXPECT_GE(result.wall_s, 30 * 1e-3 * std::min(result.frameTimes.median, result.frameTimes.cpuMedian) * 0.5);
  EXPECT_LE(result.frameTimes.median, result.frameTimes.p99);
  EXPECT_LE(result.frameTimes.p99, result.frameTimes.max);
}

TEST(RunScene, RunsAtLeastOneFrameAndContinues) {
  Simulation simulation(blockAt(0.0));
  RunOptions options;
  options.seconds = 0.001;
  EXPECT_EQ(runScene(simulation, options).frames, 1U);
  options.seconds = 0.1;
  const RunResult second = runScene(simulation, options);
  EXPECT_EQ(second.frames, 6U);
  EXPECT_NEAR(second.simulated_s, 0.1, 1e-12);
  EXPECT_NEAR(simulation.time_s, 7.0 / 60.0, 1e-12);
}

TEST(RunScene, FreeFallIsAFallAndLosesNoEnergy) {
  Scene scene = blockAt(1.0);
  Simulation simulation(scene);
  RunOptions options;
  options.seconds = 0.3;
  const RunResult result = runScene(simulation, options);
  // g t^2 / 2 is half a block's height at 43 ms: the third frame.
  EXPECT_FALSE(result.standing.stands);
  EXPECT_EQ(result.standing.fall, Fall::lower);
  ASSERT_TRUE(result.fallTime_s);
  EXPECT_NEAR(*result.fallTime_s, 3.0 / 60.0, 1e-12);
  EXPECT_FALSE(result.restTime_s);
  EXPECT_FALSE(result.maxPenetration_m) << "neither at rest nor 5 s old";
  EXPECT_FALSE(result.creep_m);
  EXPECT_EQ(result.deepest.depth, 0.0);
  EXPECT_NEAR(result.energyStart.total(), kBlockMass_kg * 9.81 * (1.0 + 0.5 * kBlockHeight_m), 1e-9);
  EXPECT_NEAR(result.energyEnd.total(), result.energyStart.total(), 1e-5 * result.energyStart.total());
  ASSERT_TRUE(result.maxEnergyRise);
  EXPECT_LT(*result.maxEnergyRise, 1e-6);
  // The last second was shorter: 18 frames at speed g t.
  double sum = 0.0;
  for (int frame = 1; frame <= 18; ++frame) sum += std::pow(9.81 * frame / 60.0, 2);
  EXPECT_NEAR(result.jitter_m_s, std::sqrt(sum / 18.0), 2e-3 * result.jitter_m_s);
}

TEST(RunScene, StopsWhenFallen) {
  Simulation simulation(blockAt(1.0));
  RunOptions options;
  options.stopWhenFallen = true;
  const RunResult result = runScene(simulation, options);
  EXPECT_EQ(result.frames, 3U);
  EXPECT_NEAR(simulation.time_s, 0.05, 1e-12);
}

TEST(RunScene, BlocksLeftOutDoNotFall) {
  Simulation simulation(blockAt(1.0));
  RunOptions options;
  options.seconds = 0.2;
  options.leftOut = {1};
  EXPECT_TRUE(runScene(simulation, options).standing.stands);
}

TEST(RunScene, StopsAWhileAfterRest) {
  Simulation simulation(blockAt(0.0));
  RunOptions options;
  options.stopWhenAtRest = true;
  options.secondsAfterRest = 0.25;
  const RunResult result = runScene(simulation, options);
  ASSERT_TRUE(result.restTime_s);
  EXPECT_LT(*result.restTime_s, 5.0);
  EXPECT_NEAR(simulation.time_s, *result.restTime_s + 0.25, 1e-9);
  EXPECT_TRUE(result.standing.stands);
  EXPECT_TRUE(result.maxPenetration_m);
  EXPECT_TRUE(result.creep_m);
}

TEST(RunScene, AStartGapIsNoFall) {
  TowerOptions tower;
  tower.startGap_m = 0.004;
  Simulation simulation(towerScene(5, tower));
  RunOptions options;
  options.seconds = 4.0;
  const RunResult result = runScene(simulation, options);
  EXPECT_TRUE(result.standing.stands) << describe(result.standing);
  EXPECT_NEAR(result.topHeightError_m, 0.0, 5e-4) << "against the tower that stands, 16 mm below the start";
}

// Every figure again, computed from the states at the callback.
TEST(RunScene, MeasuresWhatItsCallbackSees) {
  for (const Sleep sleep : {Sleep::off, Sleep::on}) {
    Scene scene = towerScene(3);
    scene.settings.sleep = sleep;
    Simulation simulation(scene);
    const ParticleArray start = simulation.state.position;
    RunOptions options;
    options.seconds = 6.0;
    std::vector<ParticleArray> positions;
    std::vector<double> meanSquareSpeeds;
    std::vector<double> energies;
    const RunResult result = runScene(simulation, options, [&](const Simulation& now) {
      positions.push_back(now.state.position);
      const double speed = rootMeanSquareCornerSpeed(now.state.velocity);
      meanSquareSpeeds.push_back(speed * speed);
      energies.push_back(energy(now).total());
    });
    ASSERT_EQ(positions.size(), 361U);
    ASSERT_TRUE(result.restTime_s);
    const auto rest = static_cast<std::size_t>(std::lround(60.0 * *result.restTime_s));
    ASSERT_LT(rest, 300U);

    double deepest = 0.0;
    double deepestAtRest = 0.0;
    double strain = 0.0;
    double creep = 0.0;
    double rise = 0.0;
    PenetrationWorkspace workspace;
    for (std::size_t i = 0; i < positions.size(); ++i) {
      const double depth = maxPenetration(positions[i], true, workspace).depth;
      deepest = std::max(deepest, depth);
      strain = std::max(strain, maxStrain(simulation.model, positions[i]));
      if (i > 0 && i < rest) rise = std::max(rise, energies[i] - energies[i - 1]);
      if (i < rest) continue;
      deepestAtRest = std::max(deepestAtRest, depth);
      creep = std::max(creep, largestCornerMove(positions[rest], positions[i]));
    }
    double sum = 0.0;
    for (std::size_t i = 301; i <= 360; ++i) sum += meanSquareSpeeds[i];

    EXPECT_TRUE(result.standing.stands);
    EXPECT_GT(deepest, 0.0);
    EXPECT_EQ(result.deepest.depth, deepest);
    EXPECT_EQ(*result.maxPenetration_m, deepestAtRest);
    EXPECT_EQ(result.maxStrain, strain);
    EXPECT_EQ(*result.creep_m, creep);
    EXPECT_NEAR(result.jitter_m_s, std::sqrt(sum / 60.0), 1e-12 * result.jitter_m_s);
    EXPECT_GE(*result.maxEnergyRise, rise / energies[0]);
    EXPECT_EQ(result.energyStart.total(), energies.front());
    EXPECT_EQ(result.energyEnd.total(), energies.back());
    const std::vector<BlockId> bottom = {blockId(0), blockId(1), blockId(2)};
    EXPECT_EQ(result.bottomRowCompression_m, meanRowCompression(simulation.model, start, positions.back(), bottom));
    EXPECT_NEAR(result.topHeightError_m, topHeight(positions.back()) - 3 * kBlockHeight_m, 1e-12);
    EXPECT_EQ(result.asleepBlocks, sleep == Sleep::on ? 9U : 0U);
    EXPECT_EQ(result.asleepBlocks + result.awakeBlocks, 9U);
    EXPECT_GT(result.substeps, 0);
    EXPECT_EQ(result.stateHash, stateHash(simulation));
  }
}

// In space at rest there is no energy at the start; the force puts some in, by which its rise is measured.
TEST(RunScene, EnergyThatIsPutInIsWhatItsRiseIsOver) {
  Scene scene = blockAt(1.0);
  scene.floor = false;
  scene.gravity.magnitude = 0.0;
  scene.forces.push_back({0, -1, Vec3(0.1, 0.0, 0.0), 0.0, 1.0});
  Simulation simulation(scene);
  RunOptions options;
  options.seconds = 1.0;
  const RunResult result = runScene(simulation, options);
  EXPECT_LT(result.energyStart.total(), 1e-20) << "rounding of the blocks' springs";
  ASSERT_TRUE(result.maxEnergyRise);
  EXPECT_NEAR(*result.maxEnergyRise, 2.0 / 60.0, 2e-3) << "t^2 rises most at its end";
}

// What falls past the floor's height has a total energy that may be zero: motion and potential cancel.
TEST(RunScene, EnergyIsNoneOfItsMagnitudeWhereItsPartsCancel) {
  Scene scene = blockAt(-0.5 * kBlockHeight_m);
  scene.floor = false;
  Simulation simulation(scene);
  RunOptions options;
  options.seconds = 1.0;
  const RunResult result = runScene(simulation, options);
  ASSERT_TRUE(result.maxEnergyRise);
  EXPECT_LT(*result.maxEnergyRise, 1e-9);
}

TEST(RunScene, MeasuresTheEndOnlyWhenAskedTo) {
  Simulation every(towerScene(2));
  Simulation end(towerScene(2));
  RunOptions options;
  options.seconds = 6.0;
  const RunResult full = runScene(every, options);
  options.measureEveryFrame = false;
  const RunResult little = runScene(end, options);
  EXPECT_EQ(little.stateHash, full.stateHash) << "measuring must not change what is measured";
  EXPECT_FALSE(little.maxEnergyRise);
  PenetrationWorkspace workspace;
  EXPECT_EQ(little.deepest.depth, maxPenetration(end.state.position, true, workspace).depth);
  EXPECT_LE(little.deepest.depth, full.deepest.depth);
  EXPECT_EQ(little.bottomRowCompression_m, full.bottomRowCompression_m);
}

}  // namespace
}  // namespace springtower
