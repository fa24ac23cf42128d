// What leads the hand, as functions of poses, camera and the mouse's way.
#include "apps/viewer/input/guided_carry.h"
#include "apps/viewer/input/guided_pull.h"
#include "apps/viewer/input/view.h"
#include "core/random.h"
#include "core/rotation_vector.h"
#include "core/tuning.h"
#include "solver/world/simulation.h"

#include <cmath>
#include <gtest/gtest.h>
#include <numbers>

namespace springtower {
namespace {

constexpr Viewport kScreen{1280, 800};
constexpr double kRightAngle = 0.5 * std::numbers::pi;
constexpr double kPitchOfRow_m = 0.5 * (kBlockLength_m - kBlockWidth_m);

ParticleArray positionsOfTower(int rows) {
  return Simulation(towerScene(rows)).state.position;
}

void moveBlock(ParticleArray& position, std::size_t block, const Vec3& way) {
  for (std::size_t c = 0; c < kCorners; ++c) position.add(block, c, way);
}

std::vector<Vec3> sizesOf(const ParticleArray& position) {
  return std::vector<Vec3>(position.blockCount(), Vec3(kBlockLength_m, kBlockWidth_m, kBlockHeight_m));
}

// Slow and plain: points on a grid of one rectangle that lie inside the other.
bool overlapOnGrid(const Footprint& a, const Footprint& b) {
  constexpr int kPoints = 20;
  for (int i = -kPoints; i <= kPoints; ++i) {
    for (int j = -kPoints; j <= kPoints; ++j) {
      const Eigen::Vector2d point = a.middle + a.axis[0] * (a.half.x() * i / kPoints) + a.axis[1] * (a.half.y() * j / kPoints);
      const Eigen::Vector2d from = point - b.middle;
      if (std::abs(from.dot(b.axis[0])) < b.half.x() && std::abs(from.dot(b.axis[1])) < b.half.y()) return true;
    }
  }
  return false;
}

TEST(Footprint, OverlapsWhereAGridSaysSo) {
  RandomStream random(11, 1);
  int overlapping = 0;
  for (int i = 0; i < 150; ++i) {
    std::array<Footprint, 2> each;
    for (Footprint& footprint : each) {
      const Vec3 place{0.1 * random.uniform(), 0.1 * random.uniform(), random.uniform()};
      footprint = footprintOf(place, rotationAbout(Vec3::UnitZ(), 6.3 * random.uniform()), {0.08, 0.027, 0.018});
      EXPECT_NEAR(footprint.half.x(), 0.04, 1e-12);
      EXPECT_NEAR(footprint.half.y(), 0.0135, 1e-12);
      EXPECT_NEAR(footprint.top_m - footprint.bottom_m, 0.018, 1e-12);
    }
    const double overlap = overlapOf(each[0], each[1]);
    if (std::abs(overlap) < 0.004) continue;  // finer than the grid
    EXPECT_EQ(overlap > 0.0, overlapOnGrid(each[0], each[1])) << i;
    overlapping += overlap > 0.0 ? 1 : 0;
  }
  EXPECT_GT(overlapping, 20);
}

TEST(Footprint, TheLevelBelowIsThatOfTheHighestBlockThere) {
  const ParticleArray position = positionsOfTower(5);
  const std::vector<Footprint> all = footprintsOf(position);
  const Footprint over = footprintOf({0.0, 0.0, 0.5}, Eigen::Quaterniond::Identity(), {0.081, 0.0267, 0.0182});
  EXPECT_NEAR(levelBelow(all, 99, over), 5 * kBlockHeight_m, 1e-9);
  const Footprint beside = footprintOf({0.09, 0.0, 0.5}, Eigen::Quaterniond::Identity(), {0.081, 0.0267, 0.0182});
  EXPECT_EQ(levelBelow(all, 99, beside), 0.0);
  // Without the three of the top row but the held one.
  const Footprint edge = footprintOf({0.0, kPitchOfRow_m, 0.5}, Eigen::Quaterniond::Identity(), {0.081, 0.0267, 0.0182});
  const std::size_t held = 14;
  EXPECT_NEAR(centre(position, held).y(), kPitchOfRow_m, 1e-3);
  EXPECT_NEAR(levelBelow(all, held, edge), 4 * kBlockHeight_m, 1e-9);
}

TEST(GuidedPull, FollowsTheAxisNearestToTheMouse) {
  const ParticleArray position = positionsOfTower(6);
  RandomStream random(5, 1);
  int pulls = 0;
  for (int i = 0; i < 600; ++i) {
    Camera camera;
    orbit(camera, 6.3 * random.uniform(), 0.6 * random.uniform() - 0.1);
    const std::size_t block = std::min<std::size_t>(17, static_cast<std::size_t>(18 * random.uniform()));
    const std::size_t axis = random.uniform() < 0.7 ? 0 : 1;
    const Vec3 way = (random.uniform() < 0.5 ? -1.0 : 1.0) * meanEdge(position, block, axis).normalized();
    const Vec3 middle = centre(position, block);
    const Eigen::Vector2d seen = *seenAt(camera, kScreen, middle + 0.03 * way) - *seenAt(camera, kScreen, middle);
    // Ways that come straight at the eye have no direction on the screen.
    if (seen.norm() * metresPerPixel(camera, kScreen, middle) < 0.4 * 0.03 || isBlocked(position, block, way)) continue;
    const double askew = axis == 0 ? 0.17 * (2.0 * random.uniform() - 1.0) : 0.0;
    const auto found = pullWay(position, block, camera, kScreen, Eigen::Rotation2Dd(askew) * seen);
    ASSERT_TRUE(found);
    EXPECT_NEAR(std::abs(found->z()), 0.0, 1e-9);
    if (axis == 1 && found->dot(way) < 0.9) continue;  // seen nearly along its length, which comes first
    EXPECT_GT(found->dot(way), 0.999) << i;
    ++pulls;
  }
  EXPECT_GT(pulls, 200);
}

TEST(GuidedPull, ANeighbourInTheWayIsNotPushed) {
  const ParticleArray position = positionsOfTower(3);
  // Row 1 lies along y: 3, 4, 5 side by side along x.
  EXPECT_TRUE(isBlocked(position, 4, Vec3::UnitX()));
  EXPECT_TRUE(isBlocked(position, 4, -Vec3::UnitX()));
  for (const std::size_t b : {3U, 4U, 5U}) {
    EXPECT_FALSE(isBlocked(position, b, Vec3::UnitY()));
    EXPECT_FALSE(isBlocked(position, b, -Vec3::UnitY()));
    const bool isFirst = centre(position, b).x() < -0.01;
    const bool isLast = centre(position, b).x() > 0.01;
    EXPECT_EQ(isBlocked(position, b, Vec3::UnitX()), !isLast) << b;
    EXPECT_EQ(isBlocked(position, b, -Vec3::UnitX()), !isFirst) << b;
  }
  const Camera camera;
  for (double angle = 0.0; angle < 6.28; angle += 0.1) {
    const auto way = pullWay(position, 4, camera, kScreen, {std::cos(angle), std::sin(angle)});
    if (way) {
      EXPECT_GT(std::abs(way->y()), 0.999) << angle;
    }
  }
}

TEST(GuidedPull, TheBlockStaysUnderTheMouse) {
  const Camera camera;
  const Vec3 point(0.03, 0.01, 0.1);
  for (const Vec3& way : {Vec3(Vec3::UnitX()), Vec3(-Vec3::UnitY())}) {
    const Vec3 to = point + 0.01 * way;
    const Eigen::Vector2d moved = *seenAt(camera, kScreen, to) - *seenAt(camera, kScreen, point);
    const double foreshortening = moved.norm() * metresPerPixel(camera, kScreen, point) / 0.01;
    EXPECT_NEAR(pulledBy(camera, kScreen, point, way, moved, moved), 0.01 * foreshortening, 2e-4);
    EXPECT_NEAR(pulledBy(camera, kScreen, point, way, moved, -moved), -0.01 * foreshortening, 2e-4);
    const Eigen::Vector2d across(-moved.y(), moved.x());
    EXPECT_NEAR(pulledBy(camera, kScreen, point, way, moved, across), 0.0, 2e-4);
    EXPECT_NEAR((leftOver(camera, kScreen, point, way, moved, across) - across).norm(), 0.0, 0.5);
    // A drag that began askew counts for the most part.
    const Eigen::Vector2d askew = Eigen::Rotation2Dd(0.35) * moved;
    EXPECT_GT(pulledBy(camera, kScreen, point, way, askew, askew), 0.98 * 0.01 * foreshortening);
  }
}

TEST(GuidedPull, SpeedsUpAndComesToRestAtTheMouse) {
  constexpr double kFrame_s = 1.0 / 60.0;
  for (const double goal : {0.1, 0.004, -0.03, 0.0}) {
    double at = 0.0;
    double speed = 0.0;
    for (int i = 0; i < 240; ++i) {
      const double next = pullSpeed(goal - at, speed, kFrame_s);
      EXPECT_LE(std::abs(next), kGuidedPull_m_s * (1.0 + 1e-12));
      EXPECT_LE(std::abs(next - speed), 0.6 * kGuidedPull_m_s);
      speed = next;
      at += kFrame_s * speed;
      EXPECT_LE(at * (goal < 0.0 ? -1.0 : 1.0), std::abs(goal) + 2e-4);
    }
    EXPECT_NEAR(at, goal, 1e-4) << goal;
  }
}

TEST(GuidedPull, ComesToPressWithAShareOfTheWeight) {
  constexpr double kFrame_s = 1.0 / 60.0;
  constexpr double kGravity_m_s2 = 9.81;
  constexpr double kRate_rad_s = 300.0;
  // The hand follows the height of a block that rests on others, as moveAlongLine does.
  double below_m = 0.0;
  for (int i = 0; i < 60; ++i) {
    below_m *= std::exp(-kFrame_s / tuning::kHeightFollowTime_s);
    below_m += pressDepth(kGravity_m_s2, kRate_rad_s, kFrame_s);
  }
  EXPECT_NEAR(below_m * kRate_rad_s * kRate_rad_s / kGravity_m_s2, kPullPress, 1e-3);
  EXPECT_EQ(pressDepth(0.0, kRate_rad_s, kFrame_s), 0.0);
  EXPECT_EQ(pressDepth(-1.0, kRate_rad_s, kFrame_s), 0.0) << "what is pulled upwards is not pressed";
}

TEST(GuidedPull, ABlockIsFreeWhenNothingIsOverIt) {
  ParticleArray position = positionsOfTower(4);
  for (std::size_t b = 0; b < 12; ++b) EXPECT_EQ(isClearAbove(position, b), b >= 9) << b;
  const Vec3 along = meanEdge(position, 4, 0).normalized();
  moveBlock(position, 4, (kBlockLength_m - 0.002) * along);
  EXPECT_FALSE(isClearAbove(position, 4));
  moveBlock(position, 4, 0.004 * along);
  EXPECT_FALSE(isClearAbove(position, 4)) << "too near to be lifted";
  moveBlock(position, 4, 0.003 * along);
  EXPECT_TRUE(isClearAbove(position, 4));
}

TEST(Places, TheTopRowHasThree) {
  ParticleArray position = positionsOfTower(4);
  const std::vector<Vec3> sizes = sizesOf(position);
  const Eigen::Quaterniond turn = Eigen::Quaterniond::Identity();
  // Of a full tower: a new row across the fourth, so along x. The held block is none of it.
  moveBlock(position, 4, {0.3, 0.0, 0.0});
  std::vector<Place> places = topPlaces(position, sizes, 4, turn);
  ASSERT_EQ(places.size(), 3U);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_NEAR(std::abs(places[i].centre.y()), i == 1 ? 0.0 : kPitchOfRow_m, 1e-9);
    EXPECT_NEAR(places[i].centre.z(), 4.5 * kBlockHeight_m, 1e-9);
    EXPECT_NEAR((places[i].turn * Vec3::UnitX()).x(), 1.0, 1e-9);
  }
  // One of them lies there already, a millimetre off: the others keep their distance.
  const Vec3 last = places[2].centre;
  const double side = last.y() > 0.0 ? 1.0 : -1.0;
  moveBlock(position, 3, -centre(position, 3));
  const Eigen::Quaterniond quarter = rotationAbout(Vec3::UnitZ(), -kRightAngle);
  for (std::size_t c = 0; c < kCorners; ++c)
    position.set(3, c, last + quarter * position.at(3, c) - Vec3(0.0, side * 0.001, 0.0));
  places = topPlaces(position, sizes, 4, turn);
  ASSERT_EQ(places.size(), 2U);
  for (const Place& place : places) {
    const double gap = -overlapOf(footprintOf(place.centre, place.turn, sizes[4]), footprintOf(position, 3));
    EXPECT_GT(gap, 1e-4);
  }
}

TEST(Places, ABlockFitsWhereItsMiddleIsHeld) {
  const ParticleArray position = positionsOfTower(4);
  const std::vector<Footprint> all = footprintsOf(position);
  const std::vector<Vec3> sizes = sizesOf(position);
  const Eigen::Quaterniond turn = Eigen::Quaterniond::Identity();
  const auto fits = [&](const Vec3& over) { return landingAt(all, sizes, 4, {over, turn}, {}, false).fits; };
  EXPECT_TRUE(fits({0.0, 0.0, 0.2}));
  EXPECT_TRUE(fits({0.02, 0.0, 0.2}));
  EXPECT_FALSE(fits({0.045, 0.0, 0.2}));
  EXPECT_FALSE(fits({0.0, 0.045, 0.2}));
  EXPECT_TRUE(fits({0.3, 0.0, 0.2})) << "on the floor";
  EXPECT_NEAR(landingAt(all, sizes, 4, {{0.3, 0.0, 0.2}, turn}, {}, false).place.centre.z(), 0.5 * kBlockHeight_m, 1e-9);
}

TEST(Places, AreTakenFromNearby) {
  ParticleArray position = positionsOfTower(4);
  moveBlock(position, 4, {0.3, 0.0, 0.0});
  const std::vector<Footprint> all = footprintsOf(position);
  const std::vector<Vec3> sizes = sizesOf(position);
  const std::vector<Place> places = topPlaces(position, sizes, 4, Eigen::Quaterniond::Identity());
  RandomStream random(3, 1);
  for (int i = 0; i < 100; ++i) {
    // Wherever its middle is over the top, whichever way it is turned.
    const Vec3 over{0.05 * random.uniform() - 0.025, 0.08 * random.uniform() - 0.04, 0.1};
    const Place carried{over, rotationAbout(Vec3::UnitZ(), 6.3 * random.uniform())};
    const Landing landing = landingAt(all, sizes, 4, carried, places, false);
    ASSERT_TRUE(landing.inRow) << over.transpose();
    EXPECT_TRUE(landing.fits);
    EXPECT_LT(std::abs(landing.place.centre.y() - over.y()), 0.5 * kPitchOfRow_m + 1e-3);
  }
  const Place across{{0.0, 0.0, 0.1}, rotationAbout(Vec3::UnitZ(), kRightAngle)};
  EXPECT_FALSE(landingAt(all, sizes, 4, across, places, true).inRow) << "the user has turned it";
}

TEST(GuidedCarry, TheHandGoesRoundTheTower) {
  ParticleArray position = positionsOfTower(8);
  const std::vector<Vec3> sizes = sizesOf(position);
  RandomStream random(9, 1);
  for (int game = 0; game < 20; ++game) {
    const std::size_t held = std::min<std::size_t>(20, static_cast<std::size_t>(21 * random.uniform()));
    ParticleArray now = position;
    const Vec3 along = meanEdge(position, held, 0).normalized();
    moveBlock(now, held, (kBlockLength_m + 0.0045) * along);
    const std::vector<Footprint> all = footprintsOf(now);
    Place hand{centre(now, held), rotationAbout(Vec3::UnitZ(), held / 3 % 2 == 0 ? 0.0 : kRightAngle)};
    Place goal{{0.04 * random.uniform() - 0.02, 0.04 * random.uniform() - 0.02, 8.5 * kBlockHeight_m + kCarryHeight_m},
               rotationAbout(Vec3::UnitZ(), random.uniform() < 0.5 ? 0.0 : kRightAngle)};
    int frames = 0;
    for (; frames < 300 && !isAt(hand, goal); ++frames) {
      hand = carryStep(all, held, sizes[held], hand, hand.centre.z(), goal, 1.0 / 60.0);
      const Footprint own = footprintOf(hand.centre, hand.turn, sizes[held]);
      for (std::size_t b = 0; b < all.size(); ++b) {
        if (b == held || overlapOf(own, all[b]) <= 0.0) continue;
        EXPECT_GE(own.bottom_m - all[b].top_m, 0.5 * kCarryHeight_m) << "game " << game << ", frame " << frames;
      }
    }
    EXPECT_TRUE(isAt(hand, goal)) << game;
    EXPECT_LT(frames, 180) << "three seconds";
  }
}

// Else a frame is refined to tuning::kMaxLedSteps.
TEST(GuidedCarry, TurnsAsFastAsTheUsualStepsOfAFrameTake) {
  constexpr double kFrame_s = 1.0 / 60.0;
  EXPECT_LT(kGuidedTurn_rad_s * kFrame_s / tuning::kStandardImplicitSteps, tuning::kMaxTurnPerStep);
  const ParticleArray position = positionsOfTower(3);
  const std::vector<Footprint> all = footprintsOf(position);
  const Vec3 over(0.0, 0.0, 4.5 * kBlockHeight_m);
  const Place goal{over, rotationAbout(Vec3::UnitZ(), kRightAngle)};
  Place hand{over, Eigen::Quaterniond::Identity()};
  int frames = 0;
  for (; frames < 100 && !isAt(hand, goal); ++frames) {
    const Place next = carryStep(all, 8, sizesOf(position)[8], hand, hand.centre.z(), goal, kFrame_s);
    EXPECT_LT(angleBetween(hand.turn, next.turn), tuning::kStandardImplicitSteps * tuning::kMaxTurnPerStep) << frames;
    hand = next;
  }
  EXPECT_LT(frames, 60) << "a second";
}

TEST(GuidedCarry, WhatIsSeenAtTheMouseIsWhereItGoes) {
  ParticleArray position = positionsOfTower(8);
  moveBlock(position, 4, {0.0, -0.09, 0.0});
  const std::vector<Footprint> all = footprintsOf(position);
  const std::vector<Vec3> sizes = sizesOf(position);
  const Camera camera;
  const Place over{centre(position, 4), rotationAbout(Vec3::UnitZ(), kRightAngle)};
  const auto carried = [&](const Vec3& target) {
    const Eigen::Vector2d moved = *seenAt(camera, kScreen, target) - *seenAt(camera, kScreen, over.centre);
    return carriedBy(camera, kScreen, all, 4, sizes[4], over, moved);
  };
  const double level = 8.5 * kBlockHeight_m;
  EXPECT_NEAR((carried({0.0, 0.0, level}) - Vec3(0.0, 0.0, level)).norm(), 0.0, 1e-9);
  EXPECT_NEAR((carried({0.02, -0.03, level}) - Vec3(0.02, -0.03, level)).norm(), 0.0, 1e-9);
  // Beside the tower it goes up and down.
  const Vec3 up = over.centre + Vec3(0.0, 0.0, 0.05);
  EXPECT_NEAR((carried(up) - up).norm(), 0.0, 1e-9);
  // Never into the floor, nor into the tower.
  EXPECT_GE(carried(over.centre - Vec3(0.0, 0.0, 0.2)).z(), 0.5 * kBlockHeight_m + kCarryHeight_m - 1e-12);
  RandomStream random(4, 1);
  for (int i = 0; i < 300; ++i) {
    const Vec3 place =
        carriedBy(camera, kScreen, all, 4, sizes[4], over, {400 * random.uniform() - 200, 400 * random.uniform() - 300});
    const Footprint own = footprintOf(place, over.turn, sizes[4]);
    EXPECT_GE(own.bottom_m, levelBelow(all, 4, own) - 1e-9);
  }
}

TEST(View, EasesSquareToTheLineAndAlong) {
  Camera camera;
  const double azimuth = squareTo(camera, Vec3::UnitX());
  EXPECT_NEAR(azimuth, -kRightAngle, 1e-12);
  EXPECT_NEAR(squareTo(camera, -Vec3::UnitX()), -kRightAngle, 1e-12);
  EXPECT_NEAR(squareTo(camera, Vec3::UnitY()), 0.0, 1e-12);
  const Camera goal = viewOfHeld(camera, azimuth, {0.1, 0.0, 0.4}, false);
  EXPECT_LE((goal.target - Vec3(0.1, 0.0, 0.4)).norm(), 0.12 + 1e-12);
  for (int i = 0; i < 21; ++i) ease(camera, goal, 1.0 / 60.0);  // 350 ms
  EXPECT_NEAR(camera.azimuth, azimuth, 0.05 * 0.67);
  for (int i = 0; i < 60; ++i) ease(camera, goal, 1.0 / 60.0);
  EXPECT_TRUE(showsTheSame(camera, goal));
  EXPECT_NEAR(std::abs(cameraFrame(camera).right.x()), 1.0, 1e-4);
}

}  // namespace
}  // namespace springtower
