// Loads and stiffness before anything has moved, against what can be worked out by hand.
#include "solver/world/load_estimate.h"

#include "core/tuning.h"
#include "solver/law/block_stiffness.h"
#include "solver/world/stiffness.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <numbers>

namespace springtower {
namespace {

constexpr double kTolerance_m = 5e-5;

BlockSpec brick(const Vec3& centre, double mass_kg = 0.1, const Vec3& dimensions_m = Vec3(0.06, 0.03, 0.02)) {
  BlockSpec block;
  block.dimensions = dimensions_m;
  block.mass = mass_kg;
  block.centre = centre;
  return block;
}

Scene sceneOf(std::vector<BlockSpec> blocks) {
  Scene scene;
  scene.blocks = std::move(blocks);
  return scene;
}

double weightOf(const Scene& scene, double mass_kg) {
  return mass_kg * scene.gravity.magnitude;
}

// Turned about the vertical through the origin, then moved.
Scene turned(Scene scene, double angle_rad, const Vec3& by) {
  const Eigen::Quaterniond turn(Eigen::AngleAxisd(angle_rad, Vec3::UnitZ()));
  for (BlockSpec& block : scene.blocks) {
    block.centre = turn * block.centre + by;
    block.orientation = turn * block.orientation;
  }
  return scene;
}

BlockStiffness stiffnessOf(const Scene& scene) {
  return stiffnessForTolerance(estimateLoads(scene), kTolerance_m);
}

void expectSameStiffness(const BlockStiffness& a, const BlockStiffness& b, double share) {
  EXPECT_NEAR(largest(a.stack_n_m), largest(b.stack_n_m), share * largest(a.stack_n_m));
  EXPECT_NEAR(largest(a.floor_n_m), largest(b.floor_n_m), share * largest(a.floor_n_m));
  EXPECT_NEAR(largest(a.edge_n_m), largest(b.edge_n_m), share * largest(a.edge_n_m));
}

TEST(LoadEstimate, ABlockOnTwoOthersRestsOnHalfItsWeightEach) {
  const Scene scene = sceneOf({brick(Vec3(-0.035, 0.0, 0.01)), brick(Vec3(0.035, 0.0, 0.01)), brick(Vec3(0.0, 0.0, 0.03), 1.0)});
  const LoadEstimate loads = estimateLoads(scene);
  ASSERT_EQ(loads.stacks.size(), 1U);
  EXPECT_EQ(loads.layers, 2);
  // The largest loads are those of the upper block put on one other block, or on the floor: half its weight a point.
  EXPECT_NEAR(loads.stacks[0].contact_n, weightOf(scene, 1.0) / tuning::kLoadedPoints, 1e-12);
  EXPECT_NEAR(loads.stacks[0].floor_n, weightOf(scene, 1.0) / tuning::kLoadedPoints, 1e-12);
  EXPECT_NEAR(loads.stacks[0].edge_n, weightOf(scene, 1.0) / tuning::kLoadedPoints, 1e-12);
}

TEST(LoadEstimate, UnequalOverlapsBearInProportionToTheirAreas) {
  // The upper brick lies by 45 mm of its 60 on the one and by 15 on the other, with ten more on top.
  std::vector<BlockSpec> bricks = {brick(Vec3(-0.015, 0.0, 0.01)), brick(Vec3(0.045, 0.0, 0.01)), brick(Vec3(0.0, 0.0, 0.03))};
  for (int i = 0; i < 10; ++i) bricks.push_back(brick(Vec3(0.0, 0.0, 0.05 + 0.02 * i)));
  const Scene scene = sceneOf(bricks);
  const LoadEstimate loads = estimateLoads(scene);
  EXPECT_NEAR(loads.stacks[0].floor_n, weightOf(scene, 0.75 * 1.1 + 0.1) / tuning::kLoadedPoints, 1e-12);
}

// A plank that leans over the edge of a column has a lower centre than the block that carries it.
TEST(LoadEstimate, LoadsPassDownWhateverTheHeightOfTheCentres) {
  BlockSpec plank = brick(Vec3(0.2, 0.0, 0.2), 1.0, Vec3(0.5, 0.02, 0.002));
  plank.orientation = Eigen::Quaterniond(Eigen::AngleAxisd(0.6, Vec3::UnitY()));
  std::vector<BlockSpec> blocks;
  for (int i = 0; i < 14; ++i) blocks.push_back(brick(Vec3(0.0, 0.0, 0.01 + 0.02 * i)));
  ASSERT_LT(plank.centre.z(), blocks.back().centre.z());
  blocks.push_back(plank);
  const LoadEstimate loads = estimateLoads(sceneOf(blocks));
  EXPECT_EQ(loads.layers, 15);
}

// f01: one of two flush bricks a tenth of a millimetre taller; the other is no support of it.
TEST(LoadEstimate, WhatStandsBesideAnotherDoesNotCarryIt) {
  for (const double into_m : {0.0, 1e-17, 1e-6, 2e-4}) {
    BlockSpec taller = brick(Vec3(0.06 - into_m, 0.0, 0.01005));
    taller.dimensions.z() = 0.0201;
    const LoadEstimate loads = estimateLoads(sceneOf({brick(Vec3(0.0, 0.0, 0.01)), taller}));
    EXPECT_EQ(loads.stacks.size(), 2U) << into_m;
    EXPECT_EQ(loads.layers, 1) << into_m;
  }
}

TEST(LoadEstimate, FlushRowsStandOnTheBlocksBelowAlone) {
  Scene scene;
  for (int row = 0; row < 8; ++row) {
    for (int column = 0; column < 6; ++column) scene.blocks.push_back(brick(Vec3(0.06 * column, 0.0, 0.01 + 0.02 * row)));
  }
  const LoadEstimate loads = estimateLoads(scene);
  EXPECT_EQ(loads.stacks.size(), 6U) << "columns of bricks straight over one another";
  for (const StackLoad& stack : loads.stacks) EXPECT_NEAR(stack.floor_n, weightOf(scene, 0.8) / tuning::kLoadedPoints, 1e-12);
}

TEST(LoadEstimate, IsTheSameForTurnedMirroredMovedAndReversedScenes) {
  TowerOptions options;
  options.heightsSigma_m = 1e-4;
  Scene scene = towerScene(18, options);
  scene.gravity.tilt_deg = 5.0;
  const BlockStiffness expected = stiffnessOf(scene);
  for (const double angle_deg : {17.0, 33.0, 45.0, 90.0, 211.0})
    expectSameStiffness(expected, stiffnessOf(turned(scene, angle_deg * std::numbers::pi / 180.0, Vec3(3.0, -1.0, 0.0))), 1e-9);
  expectSameStiffness(expected, stiffnessOf(turned(scene, 0.3, Vec3(1000.0, -1000.0, 0.0))), 1e-6);
  Scene mirrored = scene;
  for (BlockSpec& block : mirrored.blocks) {
    block.centre.x() *= -1.0;
    block.orientation =
        Eigen::Quaterniond(block.orientation.w(), block.orientation.x(), -block.orientation.y(), -block.orientation.z());
  }
  expectSameStiffness(expected, stiffnessOf(mirrored), 1e-12);
  std::reverse(scene.blocks.begin(), scene.blocks.end());
  expectSameStiffness(expected, stiffnessOf(scene), 1e-12);
}

TEST(LoadEstimate, ATowerIsAsStiffBesideOthersAsAlone) {
  const Scene alone = towerScene(18, {});
  Scene two = alone;
  for (BlockSpec block : towerScene(6, {}).blocks) {
    block.centre.x() += 1.0;
    two.blocks.push_back(block);
  }
  const BlockStiffness of = stiffnessOf(two);
  const auto expectSame = [](double of_n_m, double expected_n_m) { EXPECT_NEAR(of_n_m, expected_n_m, 1e-12 * expected_n_m); };
  expectSame(of.stack_n_m.front(), stiffnessOf(alone).stack_n_m.front());
  expectSame(of.stack_n_m.back(), stiffnessOf(towerScene(6, {})).stack_n_m.back());
}

TEST(PairStiffness, IsThatOfTheStifferStack) {
  const Scene scene = sceneOf({brick(Vec3(0.0, 0.0, 0.01), 1e-3), brick(Vec3(1.0, 0.0, 0.01), 10.0)});
  const BlockStiffness of = stiffnessOf(scene);
  const double heavy_n_m = weightOf(scene, 10.0) / (tuning::kLoadedPoints * kTolerance_m);
  EXPECT_NEAR(pairStiffness(of, 0, 1), heavy_n_m, 1e-6);
  EXPECT_EQ(pairStiffness(of, 1, 0), pairStiffness(of, 0, 1));
  EXPECT_NEAR(pairStiffness(of, 0, -1), heavy_n_m, 1e-6) << "the heavy one may come to lie on the light one";
}

TEST(PairStiffness, WithoutGravityALightBlockIsAsSoftAsAlone) {
  Scene scene = sceneOf({brick(Vec3(0.0, 0.0, 0.01), 1e-3), brick(Vec3(1.0, 0.0, 0.01), 10.0)});
  scene.gravity.magnitude = 0.0;
  const BlockStiffness of = stiffnessOf(scene);
  EXPECT_NEAR(of.edge_n_m[0], 1e-4 * of.edge_n_m[1], 1e-9 * of.edge_n_m[1]);
}

}  // namespace
}  // namespace springtower
