#include "solver/sleep/support_solver.h"

#include <array>
#include <cmath>
#include <gtest/gtest.h>

namespace springtower {
namespace {

constexpr double kSetWeight_n = 2.0;
constexpr double kHalf_m = 0.0135;  // half the side of the square on whose corners the body rests
constexpr double kHeight_m = 0.018;
constexpr double kSetFriction = 0.4;

using Square = std::array<SupportPoint, 4>;

// A body at rest on the corners of a square, a quarter of its weight on each.
Square restingSquare(double friction) {
  Square square;
  for (std::size_t i = 0; i < square.size(); ++i) {
    square[i].arm = {i % 2 == 0 ? -kHalf_m : kHalf_m, i < 2 ? -kHalf_m : kHalf_m, 0.0};
    square[i].normal = Vec3::UnitZ();
    square[i].force = 0.25 * kSetWeight_n * Vec3::UnitZ();
    square[i].friction = friction;
  }
  return square;
}

bool stays(const Vec3& force, const Vec3& torque, double friction) {
  Square square = restingSquare(friction);
  return redistribute(square, force, torque, kHeight_m, 1.0);
}

// Pulled at a height, it tips when the torque about its edge equals that of its weight.
TEST(Support, TipsOverItsEdge) {
  constexpr double kPulledAt_m = 0.1;
  const double limit_n = kSetWeight_n * kHalf_m / kPulledAt_m;
  for (const double share : {0.98, 1.02}) {
    const Vec3 force = share * limit_n * Vec3::UnitX();
    const Vec3 torque = Vec3(0.0, 0.0, kPulledAt_m).cross(force);
    EXPECT_EQ(stays(force, torque, 10.0), share < 1.0) << share;
  }
}

// The limit of a force is friction times weight; of a torque about the vertical, friction times weight times the distance of its
// corners. Within 2 %, the tolerance of Coulomb's cone.
TEST(Support, SlidesAndTurnsWhenFrictionIsUsedUp) {
  for (const double share : {0.97, 1.03}) {
    EXPECT_EQ(stays(share * kSetFriction * kSetWeight_n * Vec3::UnitY(), Vec3::Zero(), kSetFriction), share < 1.0) << share;
    const double turning = kSetFriction * kSetWeight_n * std::sqrt(2.0) * kHalf_m;
    EXPECT_EQ(stays(Vec3::Zero(), share * turning * Vec3::UnitZ(), kSetFriction), share < 1.0) << share;
  }
}

// Without friction a face still carries what presses on it straight, wherever that is within the face, and nothing along it.
TEST(Support, CarriesWithoutFriction) {
  const Vec3 press = -0.5 * Vec3::UnitZ();
  EXPECT_TRUE(stays(press, Vec3::Zero(), 0.0));
  EXPECT_TRUE(stays(press, Vec3(0.5 * kHalf_m, 0.3 * kHalf_m, 0.0).cross(press), 0.0));
  EXPECT_FALSE(stays(press + 1e-3 * Vec3::UnitX(), Vec3::Zero(), 0.0));
}

// The forces at the points balance the change, push, and are in the cone, with some points open and others slipping.
TEST(Support, BalancesAllOfTheChange) {
  const Vec3 force{0.45, 0.1, 0.3};
  const Vec3 torque = Vec3(0.0, 0.0, 0.01).cross(force) + Vec3(0.0, 0.012, 0.001);
  Square square = restingSquare(kSetFriction);
  ASSERT_TRUE(redistribute(square, force, torque, kHeight_m, 1.0));
  Vec3 sum = force;
  Vec3 moment = torque;
  int lifted = 0;
  int sliding = 0;
  for (const SupportPoint& point : square) {
    sum += point.added;
    moment += point.arm.cross(point.added);
    const Vec3 after = point.force + point.added;
    const double shear = after.head<2>().norm();
    EXPECT_GE(after.z(), -1e-12);
    EXPECT_LE(shear, kSetFriction * (after.z() + 0.02 * 0.25 * kSetWeight_n) + 1e-12);
    lifted += point.state == SupportState::open ? 1 : 0;
    sliding += point.state == SupportState::slip ? 1 : 0;
  }
  EXPECT_LT(sum.norm(), 1e-12);
  EXPECT_LT(moment.norm(), 1e-13);
  EXPECT_GT(lifted + sliding, 0) << "or the test tests nothing but springs";
}

TEST(Support, HoldsNothingWithoutPoints) {
  EXPECT_FALSE(redistribute({}, Vec3::Zero(), Vec3::Zero(), kHeight_m, 1.0));
}

// Two points support it, but not against a rotation about the line through them.
TEST(Support, OnALineIsFreeToTurn) {
  Square square = restingSquare(10.0);
  EXPECT_FALSE(redistribute(std::span(square).first(2), Vec3::Zero(), 1e-4 * Vec3::UnitX(), kHeight_m, 1.0));
}

}  // namespace
}  // namespace springtower
