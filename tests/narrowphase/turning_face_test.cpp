// Directions that rotate with a block, as separating axes.
#include "narrowphase/turning_face.h"

#include "core/random.h"

#include <Eigen/Geometry>
#include <gtest/gtest.h>

namespace springtower {
namespace {

const Vec3 kDimensions_m(0.075, 0.025, 0.015);

// Blocks 0 and 1 at the start of a step and at its end.
struct Step {
  ParticleArray start;
  ParticleArray end;

  Step() {
    start.resize(2);
    end.resize(2);
  }
  [[nodiscard]] MovingBlock block(std::size_t b) const { return {cornersOf(start, b), cornersOf(end, b)}; }
};

void place(ParticleArray& corners, std::size_t block, const Eigen::Quaterniond& turn, const Vec3& centre) {
  for (std::size_t c = 0; c < kCorners; ++c) {
    const Vec3 side(cornerSide(c, 0), cornerSide(c, 1), cornerSide(c, 2));
    corners.set(block, c, turn * Vec3(0.5 * side.cwiseProduct(kDimensions_m)) + centre);
  }
}

// Two blocks of a row, separated by a gap, that rotate together about the vertical axis through the centre of the first one.
Step rowThatTurns(double gap_m, double turn_rad) {
  const Vec3 aside(0.0, kDimensions_m.y() + gap_m, 0.0);
  const Eigen::Quaterniond turn(Eigen::AngleAxisd(turn_rad, Vec3::UnitZ()));
  Step step;
  place(step.start, 0, Eigen::Quaterniond::Identity(), aside);
  place(step.start, 1, Eigen::Quaterniond::Identity(), Vec3::Zero());
  place(step.end, 0, turn, turn * aside);
  place(step.end, 1, turn, Vec3::Zero());
  return step;
}

// The gap closes along the direction that separates the blocks at the start, by half their length times the angle on either side;
// along the direction that rotates with them it closes by at most the difference between an arc and its chord.
TEST(TurningFace, SeparatesBlocksThatTurnTogether) {
  const double gap_m = 1e-4;
  const double turn_rad = 0.01;
  const Step step = rowThatTurns(gap_m, turn_rad);
  EXPECT_LT(gapAlong(Vec3::UnitY(), step.block(0).end, step.block(1).end), gap_m - 0.9 * kDimensions_m.x() * turn_rad);
  const TurningGap turning = gapAlongTurningFace(Vec3::UnitY(), step.block(0), step.block(1));
  EXPECT_NEAR(turning.least, gap_m, 0.25 * turn_rad * turn_rad * kDimensions_m.x());
  EXPECT_NEAR(gapAlong(turning.normalAtEnd, step.block(0).end, step.block(1).end), gap_m, 1e-12);
}

TEST(TurningFace, TakesTheFaceOfEitherBlock) {
  Step step = rowThatTurns(1e-4, 0.0);
  const Eigen::Quaterniond tilt(Eigen::AngleAxisd(0.3, Vec3::UnitX()));
  place(step.start, 0, tilt, Vec3(0.0, 0.04, 0.0));
  place(step.end, 0, tilt, Vec3(0.0, 0.04, 0.0));
  const Vec3 own = tilt * Vec3::UnitY();
  EXPECT_LT((gapAlongTurningFace(own, step.block(0), step.block(1)).normalAtEnd - own).norm(), 1e-12);
  EXPECT_LT((gapAlongTurningFace(Vec3::UnitY(), step.block(0), step.block(1)).normalAtEnd - Vec3::UnitY()).norm(), 1e-12);
}

// The least gap is at most the gap at any time, with the corners on their straight paths.
TEST(TurningFace, NeverExceedsTheGap) {
  RandomStream random(7, 0);
  const auto number = [&](double most) { return most * (2.0 * random.uniform() - 1.0); };
  const auto shift = [&](double most) { return Vec3(number(most), number(most), number(most)); };
  const auto turn = [&](double most) { return Eigen::Quaterniond(1.0, number(most), number(most), number(most)).normalized(); };
  int promised = 0;
  for (int i = 0; i < 2000; ++i) {
    Step step;
    const Vec3 between = Vec3(0.0, 0.027, 0.0) + shift(0.002);
    for (std::size_t b = 0; b < 2; ++b) {
      const Eigen::Quaterniond from = turn(0.02);
      const Vec3 centre = b == 0 ? between : Vec3::Zero();
      place(step.start, b, from, centre);
      place(step.end, b, turn(0.05) * from, centre + shift(0.002));
    }
    const TurningGap turning = gapAlongTurningFace(Vec3::UnitY(), step.block(0), step.block(1));
    if (turning.least <= 0.0) continue;
    ++promised;
    Counters counters;
    EXPECT_FALSE(featuresMeet(step.block(0), step.block(1), counters)) << "case " << i;
    ParticleArray now;
    now.resize(2);
    for (const double time : {0.0, 0.25, 0.5, 0.75, 1.0}) {
      for (std::size_t b = 0; b < 2; ++b) {
        for (std::size_t c = 0; c < kCorners; ++c) now.set(b, c, (1.0 - time) * step.start.at(b, c) + time * step.end.at(b, c));
      }
      EXPECT_GT(findSeparation(cornersOf(now, 0), cornersOf(now, 1)).best(), 0.99 * turning.least)
          << "case " << i << ", " << time;
    }
  }
  EXPECT_GT(promised, 300);
}

}  // namespace
}  // namespace springtower
