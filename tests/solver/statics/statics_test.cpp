#include "solver/statics/statics.h"

#include "core/error.h"
#include "solver/statics/linear_program.h"
#include "solver/statics/tilt_limits.h"

#include <array>
#include <cmath>
#include <gtest/gtest.h>
#include <numbers>
#include <oneapi/tbb/global_control.h>

namespace springtower {
namespace {

constexpr double kDegrees = 180.0 / std::numbers::pi;
constexpr double kHalfWidth_m = 0.5 * kBlockWidth_m;
constexpr double kWeight_n = kBlockMass_kg * kStandardGravity_m_s2;
// The margin's own tolerance, and the difference between the pyramid and the cone.
constexpr double kTilt_deg = 0.012;

Scene withFriction(Scene scene, double friction) {
  scene.staticFriction = friction;
  scene.kineticFriction = friction;
  return scene;
}

Scene tilted(Scene scene, double tilt_deg, double direction_deg) {
  scene.gravity.tilt_deg = tilt_deg;
  scene.gravity.direction_deg = direction_deg;
  return scene;
}

// Blocks on one another, all along x, each displaced along y from the one below.
Scene stack(const std::vector<double>& offsets_m) {
  Scene scene;
  Vec3 centre(0.0, 0.0, 0.5 * kBlockHeight_m);
  for (const double offset : offsets_m) {
    centre.y() += offset;
    scene.blocks.emplace_back().centre = centre;
    centre.z() += kBlockHeight_m;
  }
  return scene;
}

Scene loneBlock(double friction) {
  return withFriction(stack({0.0}), friction);
}

double margin_deg(const Scene& scene) {
  const std::optional<StabilityMargin> margin = tiltMargin(staticScene(scene));
  return margin ? margin->tilt_deg : -90.0;
}

Rest restOf(const Scene& scene) {
  return staticScene(scene).rest;
}

TEST(Statics, ABlockSlidesAtTheFrictionAngle) {
  for (const double friction : {0.1, 0.4, 1.0})
    EXPECT_NEAR(margin_deg(loneBlock(friction)), kDegrees * std::atan(friction), kTilt_deg);
  EXPECT_EQ(restOf(tilted(loneBlock(0.4), 21.7, 33.0)), Rest::stands);
  EXPECT_EQ(restOf(tilted(loneBlock(0.4), 21.9, 33.0)), Rest::falls);
}

TEST(Statics, ABlockTipsOverItsNarrowSideWhenItCannotSlide) {
  const std::optional<StabilityMargin> margin = tiltMargin(staticScene(loneBlock(5.0)));
  ASSERT_TRUE(margin);
  EXPECT_NEAR(margin->tilt_deg, kDegrees * std::atan(kBlockWidth_m / kBlockHeight_m), kTilt_deg);
  EXPECT_TRUE(std::abs(margin->direction_deg - 90.0) < 0.1 || std::abs(margin->direction_deg - 270.0) < 0.1)
      << margin->direction_deg;
  EXPECT_NEAR(tiltTowards(staticScene(loneBlock(5.0)), 0.0).value_or(0.0), kDegrees * std::atan(kBlockLength_m / kBlockHeight_m),
              kTilt_deg);
}

TEST(Statics, WithoutFrictionOnlyGravityStraightDownIsBalanced) {
  EXPECT_EQ(restOf(loneBlock(0.0)), Rest::stands);
  EXPECT_NEAR(margin_deg(loneBlock(0.0)), 0.0, kTilt_deg);
  EXPECT_EQ(restOf(tilted(loneBlock(0.0), 1.0, 0.0)), Rest::falls);
}

TEST(Statics, TheMarginIsCountedFromTheScenesGravity) {
  const std::optional<StabilityMargin> leaning = tiltMargin(staticScene(tilted(loneBlock(0.4), 10.0, 0.0)));
  ASSERT_TRUE(leaning);
  EXPECT_NEAR(leaning->tilt_deg, kDegrees * std::atan(0.4) - 10.0, kTilt_deg);
  EXPECT_NEAR(leaning->direction_deg, 0.0, 0.5);
  // A block that slides stands again when gravity is rotated back by the excess.
  const std::optional<StabilityMargin> sliding = tiltMargin(staticScene(tilted(loneBlock(0.4), 25.0, 90.0)));
  ASSERT_TRUE(sliding);
  EXPECT_NEAR(sliding->tilt_deg, kDegrees * std::atan(0.4) - 25.0, kTilt_deg);
  EXPECT_NEAR(sliding->direction_deg, 270.0, 0.5);
}

TEST(Statics, OverhangsAsFarAsTheHarmonicSeries) {
  const double hair = 1e-5;
  EXPECT_EQ(restOf(stack({0.0, kHalfWidth_m - hair})), Rest::stands);
  EXPECT_EQ(restOf(stack({0.0, kHalfWidth_m + hair})), Rest::falls);
  // From the top: a half, a quarter, a sixth of the width, each over the edge of the next.
  const auto harmonic = [](double more) {
    return stack({0.0, kHalfWidth_m / 3.0 + more, kHalfWidth_m / 2.0 - 1e-6, kHalfWidth_m - 1e-6});
  };
  EXPECT_EQ(restOf(harmonic(-hair)), Rest::stands);
  EXPECT_EQ(restOf(harmonic(hair)), Rest::falls);
}

TEST(Statics, ATowerTipsOverTheEdgeItsCentreOfMassPasses) {
  EXPECT_NEAR(margin_deg(bitCodeScene("(010)-(010)-(010)-(010)-(010)-(010)")),
              kDegrees * std::atan(kHalfWidth_m / (3.0 * kBlockHeight_m)), kTilt_deg);
  // A beam across a block: it tips alone, or both do, whichever comes first.
  const auto beam = [](double offset_m) {
    return withFriction(bitCodeScene("(010)-(010)", {.offsets = {{.row = 1, .position = 2, .dx = 0.0, .dy = offset_m}}}), 5.0);
  };
  EXPECT_NEAR(margin_deg(beam(0.012)), kDegrees * std::atan((kHalfWidth_m - 0.012) / (0.5 * kBlockHeight_m)), kTilt_deg);
  EXPECT_NEAR(margin_deg(beam(0.0)), kDegrees * std::atan(kHalfWidth_m / kBlockHeight_m), kTilt_deg);
  // A full tower tips together with the outer block of its lowest row, over that block's edge.
  const double above = 51.0 * 0.5 * kBlockLength_m + kHalfWidth_m;
  const double rise = 51.0 * 9.5 * kBlockHeight_m + 0.5 * kBlockHeight_m;
  EXPECT_NEAR(margin_deg(towerScene(18)), kDegrees * std::atan(above / rise), kTilt_deg);
}

TEST(Statics, ATowerThatFallsHasANegativeMargin) {
  // The report's second configuration: its support ends 0.22 mm before the common centre of mass.
  const std::optional<StabilityMargin> margin = tiltMargin(staticScene(bitCodeScene("(001)-(010)-(001)")));
  ASSERT_TRUE(margin);
  EXPECT_NEAR(margin->tilt_deg, -0.71, 0.01);
  // A block with nothing under it falls under any gravity.
  Scene floating = stack({0.0});
  floating.blocks[0].centre.z() += 0.1;
  EXPECT_EQ(restOf(floating), Rest::falls);
  EXPECT_FALSE(tiltMargin(staticScene(floating)));
}

TEST(Statics, SizeAndDensityChangeNothing) {
  const Scene scene = bitCodeScene("(011)-(110)-(010)-(111)");
  const double expected = margin_deg(scene);
  for (const double scale : {0.1, 10.0}) {
    Scene other = scene;
    for (BlockSpec& block : other.blocks) {
      block.centre *= scale;
      block.dimensions *= scale;
      block.mass *= 7.0;
    }
    EXPECT_NEAR(margin_deg(other), expected, 1e-4);
  }
}

// No direction, computed one by one, gives less than the margin found, and the worst of them hardly more.
TEST(Statics, NoDirectionIsWorseThanTheWorst) {
  const Scene scene = bitCodeScene(
      "(110)-(011)-(111)-(101)-(010)",
      {.offsets = {{.row = 1, .position = 2, .dx = -0.004, .dy = 0.006}, {.row = 4, .position = 2, .dx = 0.003, .dy = -0.005}}});
  const StaticScene statics = staticScene(scene);
  const std::optional<StabilityMargin> margin = tiltMargin(statics);
  ASSERT_TRUE(margin);
  ASSERT_EQ(statics.rest, Rest::stands);
  double least = 90.0;
  for (int direction = 0; direction < 360; direction += 6) {
    least = std::min(least, tiltTowards(statics, direction).value_or(-90.0));
  }
  EXPECT_GE(least, margin->tilt_deg - kTilt_deg);
  EXPECT_LE(least, margin->tilt_deg + 0.1);
  EXPECT_NEAR(tiltTowards(statics, margin->direction_deg).value_or(-90.0), margin->tilt_deg, 0.05);
}

// The limits in closed form are necessary: no linear program exceeds one.
TEST(Statics, NoEquilibriumPassesALimit) {
  for (const char* code : {"(111)-(111)-(111)", "(011)-(110)-(010)-(111)", "(101)-(010)-(010)-(110)-(101)"}) {
    const StaticScene statics = staticScene(bitCodeScene(code));
    const StaticsModel& model = statics.model;
    EquilibriumProgram program(model, statics.usable, model.gravityLoad(-Vec3::UnitZ()));
    for (const Vec3& side : {Vec3(Vec3::UnitX()), Vec3(Vec3::UnitY())}) {
      program.setBounds(program.addVariableLoad(model.gravityLoad(side)), -50.0, 50.0);
    }
    ASSERT_TRUE(program.isFeasible());
    const std::vector<GravityLimit> limits = gravityLimits(model, statics.usable);
    EXPECT_GE(limits.size(), 12U);
    for (const GravityLimit& limit : limits) {
      EXPECT_LE(program.maximise(std::array{limit.direction.x(), limit.direction.y()}), limit.bound + 1e-6) << code;
    }
  }
}

// The contact forces balance each block and are inside the cones, for unequal masses under tilted gravity.
TEST(Statics, ForcesBalanceEveryBlock) {
  const Scene scene = tilted(towerScene(6, {.massSigma_kg = 0.00185, .seed = 5}), 7.0, 40.0);
  const StaticScene statics = staticScene(scene);
  ASSERT_EQ(statics.rest, Rest::stands);
  const ContactLoads loads = contactLoads(statics);
  EXPECT_FALSE(loads.anyOfMany);
  std::vector<Vec3> force;
  std::vector<Vec3> torque(scene.blocks.size(), Vec3::Zero());
  for (const BlockSpec& block : scene.blocks) force.push_back(block.mass * scene.gravity.at(0.0));
  for (std::size_t c = 0; c < statics.facings.size(); ++c) {
    const FacePair& facing = statics.facings[c];
    Vec3 sum = Vec3::Zero();
    for (std::size_t p = 0; p < facing.points.size(); ++p) {
      const Vec3& pushed = loads.contacts[c].pointForces[p];
      sum += pushed;
      const double normal = pushed.dot(facing.normal);
      EXPECT_LE((pushed - normal * facing.normal).norm(), scene.staticFriction * normal + 1e-9);
      for (const auto& [block, sign] : {std::pair{facing.upper, 1.0}, std::pair{facing.lower, -1.0}}) {
        if (block == kFloor) continue;
        force[index(block)] += sign * pushed;
        torque[index(block)] += sign * (facing.points[p].place - scene.blocks[index(block)].centre).cross(pushed);
      }
    }
    EXPECT_LT((sum - loads.contacts[c].force).norm(), 1e-12);
  }
  for (std::size_t b = 0; b < force.size(); ++b) {
    EXPECT_LT(force[b].norm(), 1e-7 * kWeight_n) << b;
    EXPECT_LT(torque[b].norm(), 1e-7 * kWeight_n * kBlockHeight_m) << b;
  }
}

TEST(Statics, ThreeSupportsShareALoadEquallyOrInManyWays) {
  const StaticScene statics = staticScene(bitCodeScene("(111)-(010)"));
  const std::vector<BlockLoad> blocks = blockLoads(statics, contactLoads(statics));
  for (std::size_t b = 0; b < 3; ++b) {
    EXPECT_NEAR(blocks[b].weight_n, kWeight_n, 1e-9);
    EXPECT_NEAR(blocks[b].above_n, kWeight_n / 3.0, 1e-6);
    EXPECT_NEAR(blocks[b].leastAbove_n, 0.0, 1e-6);
    EXPECT_TRUE(blocks[b].covered);
    EXPECT_FALSE(blocks[b].loose);
  }
  // The middle one may carry all of it; an outer one half of it, at its inner edge with the far edge of the middle one.
  EXPECT_NEAR(blocks[1].greatestAbove_n.value_or(0.0), kWeight_n, 1e-6);
  const double near_m = 0.5 * kBlockLength_m - kBlockWidth_m;
  EXPECT_NEAR(blocks[0].greatestAbove_n.value_or(0.0), kWeight_n * 0.5 * kBlockLength_m / (0.5 * kBlockLength_m + near_m), 1e-6);
  EXPECT_FALSE(blocks[3].covered);
  EXPECT_EQ(blocks[3].above_n, 0.0);
}

TEST(Statics, ALooseBlockCarriesNothingUntilTheBlockOverItLeans) {
  const Scene scene = bitCodeScene("(1L1)-(010)-(010)");
  const StaticScene statics = staticScene(scene);
  EXPECT_EQ(statics.rest, Rest::stands);
  const std::vector<BlockLoad> blocks = blockLoads(statics, contactLoads(statics));
  EXPECT_TRUE(blocks[1].loose);
  EXPECT_EQ(blocks[1].above_n, 0.0);
  EXPECT_NEAR(blocks[1].gap_m, 0.0003, 1e-9);
  EXPECT_FALSE(blocks[0].loose);
  EXPECT_NEAR(blocks[0].above_n, kWeight_n, 1e-6);
  EXPECT_EQ(removalOf(scene, blockId(1)).rest, Rest::stands);

  // Without the outer block the two above rotate about the inner edge of the other one, until the far edge of the loose one stops
  // them.
  Scene leaning = scene;
  leaning.blocks.erase(leaning.blocks.begin());
  EXPECT_EQ(removalOf(scene, blockId(0)).rest, Rest::leans);
  const StaticScene leaned = staticScene(leaning);
  ASSERT_EQ(leaned.rest, Rest::leans);
  const double edge_m = 0.5 * kBlockLength_m - kBlockWidth_m;
  EXPECT_NEAR(leaned.settlement_m, 0.0003 * edge_m / (edge_m + kHalfWidth_m), 1e-9);
  const std::vector<BlockLoad> after = blockLoads(leaned, contactLoads(leaned));
  EXPECT_NEAR(after[0].above_n, 2.0 * kWeight_n * edge_m / (edge_m + kHalfWidth_m), 1e-6);
  EXPECT_EQ(after[0].gap_m, 0.0);
}

// With varying heights every block rests on three points and the loads are unique; a block without contact has a gap.
TEST(Statics, VaryingHeightsLeaveBlocksLoose) {
  const StaticScene statics = staticScene(towerScene(6, {.heightsSigma_m = 0.0002, .seed = 3}));
  ASSERT_EQ(statics.rest, Rest::leans);
  const std::vector<BlockLoad> blocks = blockLoads(statics, contactLoads(statics));
  std::size_t loose = 0;
  for (std::size_t b = 0; b < blocks.size(); ++b) {
    if (!blocks[b].covered) continue;
    ASSERT_TRUE(blocks[b].greatestAbove_n);
    EXPECT_NEAR(blocks[b].leastAbove_n, *blocks[b].greatestAbove_n, 1e-3 * kWeight_n) << b;
    EXPECT_EQ(blocks[b].loose, blocks[b].gap_m > 0.0) << b;
    loose += blocks[b].loose ? 1 : 0;
  }
  EXPECT_GE(loose, 3U);
  for (std::size_t row = 0; row < 5; ++row) {
    double carried = 0.0;
    for (std::size_t p = 0; p < 3; ++p) carried += blocks[3 * row + p].above_n;
    EXPECT_NEAR(carried, static_cast<double>(3 * (5 - row)) * kWeight_n, 1e-6);
  }
}

TEST(Statics, RemovalsBringDownWhatTheyCarry) {
  const Scene scene = bitCodeScene("(010)-(101)-(010)-(111)");
  const std::vector<Removal> all = removals(scene);
  ASSERT_EQ(all.size(), 7U);
  const std::vector<Rest> expected = {Rest::falls,  Rest::falls,  Rest::falls, Rest::falls,
                                      Rest::stands, Rest::stands, Rest::stands};
  for (std::size_t b = 0; b < all.size(); ++b) {
    EXPECT_EQ(all[b].rest, expected[b]) << b;
    const Removal alone = removalOf(scene, blockId(b));
    EXPECT_EQ(alone.margin.has_value(), all[b].margin.has_value());
    if (alone.margin) {
      EXPECT_EQ(alone.margin->tilt_deg, all[b].margin->tilt_deg);
    }
  }
  const Removal nothingLeft = removalOf(loneBlock(0.4), blockId(0));
  EXPECT_EQ(nothingLeft.rest, Rest::stands);
  EXPECT_FALSE(nothingLeft.margin);
}

TEST(Statics, AnswersAreTheSameForAnyThreads) {
  const Scene scene = towerScene(5, {.heightsSigma_m = 0.0002, .seed = 2});
  const auto solve = [&](std::size_t threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    return removals(scene);
  };
  const std::vector<Removal> one = solve(1);
  const std::vector<Removal> four = solve(4);
  for (std::size_t b = 0; b < one.size(); ++b) {
    EXPECT_EQ(one[b].rest, four[b].rest);
    ASSERT_EQ(one[b].margin.has_value(), four[b].margin.has_value());
    if (one[b].margin) {
      EXPECT_EQ(one[b].margin->tilt_deg, four[b].margin->tilt_deg);
    }
  }
}

TEST(Statics, APulledBlockHoldsByItsFriction) {
  const StaticScene alone = staticScene(loneBlock(0.4));
  EXPECT_NEAR(pullLimit(alone, blockId(0), Vec3::UnitX()).value_or(0.0), 0.4 * kWeight_n, 1e-4 * kWeight_n);
  EXPECT_NEAR(pullLimit(alone, blockId(0), Vec3::UnitZ()).value_or(0.0), kWeight_n, 1e-6 * kWeight_n);
  EXPECT_TRUE(std::isinf(pullLimit(alone, blockId(0), -Vec3::UnitZ()).value_or(0.0)));
  // The blocks above are held only by their own contacts: here there are none.
  const StaticScene three = staticScene(bitCodeScene("(010)-(010)-(010)"));
  EXPECT_NEAR(pullLimit(three, blockId(0), Vec3::UnitX()).value_or(0.0), 0.4 * 3.0 * kWeight_n, 1e-3 * kWeight_n);
  EXPECT_FALSE(pullLimit(staticScene(bitCodeScene("(001)-(100)")), blockId(0), Vec3::UnitX()));
}

TEST(Statics, FacesThatTouchAreFound) {
  const std::vector<FacePair> tower = facingBlocks(towerScene(2), 0.0);
  ASSERT_EQ(tower.size(), 3U + 9U);
  for (const FacePair& facing : tower) {
    EXPECT_EQ(facing.points.size(), 4U);
    EXPECT_EQ(facing.normal, Vec3(Vec3::UnitZ()));
    for (const FacingPoint& point : facing.points) EXPECT_EQ(point.gap_m, 0.0);
  }
  // Squares rotated by 45 degrees overlap in an octagon.
  Scene turned = stack({0.0, 0.0});
  for (BlockSpec& block : turned.blocks) block.dimensions = Vec3(0.03, 0.03, kBlockHeight_m);
  turned.blocks[1].orientation = Eigen::AngleAxisd(std::numbers::pi / 4.0, Vec3::UnitZ());
  const std::vector<FacePair> octagon = facingBlocks(turned, 0.0);
  ASSERT_EQ(octagon.size(), 2U);
  EXPECT_EQ(octagon[1].points.size(), 8U);
  // Flush sides: one block beside another, touching along a whole face.
  Scene beside = stack({0.0});
  beside.blocks.push_back(beside.blocks[0]);
  beside.blocks[1].centre.y() += kBlockWidth_m;
  const std::vector<FacePair> flush = facingBlocks(beside, 0.0);
  ASSERT_EQ(flush.size(), 3U);
  EXPECT_EQ(restOf(beside), Rest::stands);
}

TEST(Statics, NeedsGravity) {
  Scene scene = loneBlock(0.4);
  scene.gravity.magnitude = 0.0;
  EXPECT_THROW(staticScene(scene), InputError);
}

}  // namespace
}  // namespace springtower
