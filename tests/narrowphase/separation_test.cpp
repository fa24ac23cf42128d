// The direction along which two blocks are level, across the one that separates them best.
#include "narrowphase/separation.h"

#include "core/state.h"

#include <Eigen/Geometry>
#include <gtest/gtest.h>

namespace springtower {
namespace {

const Vec3 kTile_m(0.1, 0.2, 0.02);
constexpr GrazingLimits kLimits{1e-4, 1e-4};

// A tile at the origin, b, and another, a, on the level of its top and beside it, pitched about y.
Separation besideTop(double gap_m, double sunk_m, double pitch_rad) {
  ParticleArray position;
  position.resize(2);
  const Vec3 beside(-kTile_m.x() - gap_m, 0.0, kTile_m.z() - sunk_m);
  for (std::size_t c = 0; c < kCorners; ++c) {
    const Vec3 corner = 0.5 * Vec3(cornerSide(c, 0), cornerSide(c, 1), cornerSide(c, 2)).cwiseProduct(kTile_m);
    // About its lower edge next to the other tile.
    const Vec3 edge(0.5 * kTile_m.x(), 0.0, -0.5 * kTile_m.z());
    position.set(0, c, beside + edge + Eigen::AngleAxisd(pitch_rad, Vec3::UnitY()) * (corner - edge));
    position.set(1, c, corner);
  }
  return findSeparation(cornersOf(position, 0), cornersOf(position, 1));
}

TEST(Level, IsTheOverlapAcrossTheBestDirection) {
  const Separation apart = besideTop(3e-4, 2e-5, 0.0);
  EXPECT_NEAR(apart.best(), 3e-4, 1e-12);
  EXPECT_NEAR(apart.bestNormal().x(), -1.0, 1e-12);
  EXPECT_NEAR(apart.level, -2e-5, 1e-12);
  EXPECT_NEAR(apart.normalLevel.z(), 1.0, 1e-12);
  EXPECT_EQ(apart.levelFaceOfA, 4) << "its lower face";
  EXPECT_EQ(apart.levelFaceOfB, 5) << "its upper face";
}

// A tile that is pitched is as deep as its near edge, not as the far end of either.
TEST(Level, OfAPitchedBlockIsThatOfItsNearEdge) {
  for (const double pitch_rad : {-5e-3, -1e-3, 1e-3}) {
    const Separation apart = besideTop(3e-4, 2e-5, pitch_rad);
    EXPECT_NEAR(apart.level, -2e-5, std::abs(pitch_rad) * 4e-4 + 1e-9 + (pitch_rad > 0.0 ? kTile_m.x() * pitch_rad : 0.0))
        << pitch_rad;
  }
}

TEST(Grazing, DependsOnTheOverlapAndOnTheWayTheBlocksMove) {
  const Vec3 along(0.5, 0.1, 0.0);
  const Vec3 down(0.01, 0.0, -0.5);
  for (const double gap_m : {3e-4, -1e-5}) {
    EXPECT_TRUE(grazes(besideTop(gap_m, 2e-5, 0.0), kLimits, along));
    EXPECT_FALSE(grazes(besideTop(gap_m, 2e-5, 0.0), kLimits, down)) << "it falls onto the edge";
    EXPECT_FALSE(grazes(besideTop(gap_m, 2e-5, 0.0), kLimits, Vec3::Zero())) << "it rests";
    EXPECT_FALSE(grazes(besideTop(gap_m, 2e-5, 0.0), kLimits, Vec3(1e-9, 0.0, 0.0))) << "it rests, but for rounding";
    EXPECT_FALSE(grazes(besideTop(gap_m, 5e-4, 0.0), kLimits, along)) << "a step";
  }
  EXPECT_FALSE(grazes(besideTop(-1e-3, 2e-5, 0.0), kLimits, along)) << "it is on it: that is the best direction";
}

TEST(Grazing, LeavesTheDirectionAlongWhichTheyAreLevel) {
  const Separation level = alongLevel(besideTop(-1e-5, 2e-5, 0.0));
  EXPECT_NEAR(level.best(), -2e-5, 1e-12);
  EXPECT_NEAR(level.bestNormal().z(), 1.0, 1e-12);
}

}  // namespace
}  // namespace springtower
