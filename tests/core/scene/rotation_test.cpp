// Orientations as scene files write them.
#include "core/scene/rotation.h"

#include "core/random.h"

#include <cmath>
#include <gtest/gtest.h>

namespace springtower {
namespace {

TEST(Rotation, OfAQuarterTurnIsThatAboutItsAxis) {
  const Vec3 turned = orientationOfRotation(Vec3(0.0, 0.0, 90.0)) * Vec3(Vec3::UnitX());
  EXPECT_NEAR((turned - Vec3::UnitY()).norm(), 0.0, 1e-15);
  EXPECT_EQ(orientationOfRotation(Vec3::Zero()).coeffs(), Eigen::Quaterniond::Identity().coeffs());
}

TEST(Rotation, OfFewDecimalsComesBackToTheLastBit) {
  RandomStream random(3, 0);
  for (int i = 0; i < 1000; ++i) {
    Vec3 rotation_deg;
    for (double& component : rotation_deg) component = std::round(1e3 * (200.0 * random.uniform() - 100.0)) / 1e3;
    if (rotation_deg.norm() > 180.0) continue;
    const Eigen::Quaterniond orientation = orientationOfRotation(rotation_deg);
    EXPECT_EQ(rotationOfOrientation(orientation), rotation_deg);
  }
}

TEST(Rotation, OfAnyOrientationIsNearlyTheSame) {
  RandomStream random(4, 0);
  for (int i = 0; i < 1000; ++i) {
    Eigen::Quaterniond orientation{random.normal(), random.normal(), random.normal(), random.normal()};
    orientation.normalize();
    const Vec3 rotation_deg = rotationOfOrientation(orientation);
    EXPECT_LE(rotation_deg.norm(), 180.0 + 1e-9);
    EXPECT_LT(orientationOfRotation(rotation_deg).angularDistance(orientation), 1e-7);  // whose arc cosine loses half the digits
    EXPECT_NEAR(std::abs(orientationOfRotation(rotation_deg).dot(orientation)), 1.0, 1e-14);
  }
}

}  // namespace
}  // namespace springtower
