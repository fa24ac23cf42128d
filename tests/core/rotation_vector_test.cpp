#include "core/rotation_vector.h"

#include "core/random.h"

#include <cmath>
#include <gtest/gtest.h>
#include <numbers>

namespace springtower {
namespace {

// Rounding of a few operations on numbers up to pi.
constexpr double kRounding = 4e-15;

Vec3 drawn(RandomStream& random, double length) {
  const Vec3 direction{random.normal(), random.normal(), random.normal()};
  return length * direction.normalized();
}

TEST(RotationVector, IsThatOfEigensAxisAndAngle) {
  RandomStream random(1, 0);
  for (int draw = 0; draw < 1000; ++draw) {
    const double angle = std::numbers::pi * random.uniform();
    const Vec3 vector = drawn(random, angle);
    const Eigen::Quaterniond expected(Eigen::AngleAxisd(angle, vector.normalized()));
    EXPECT_LT((rotation(vector).coeffs() - expected.coeffs()).norm(), kRounding);
    EXPECT_LT((rotationVector(expected) - vector).norm(), kRounding);
    const Eigen::Quaterniond other(-expected.w(), -expected.x(), -expected.y(), -expected.z());  // the same rotation
    EXPECT_LT((rotationVector(other) - vector).norm(), kRounding);
  }
}

TEST(RotationVector, OfNoRotationIsZero) {
  EXPECT_EQ(rotationVector(Eigen::Quaterniond::Identity()), Vec3::Zero());
  EXPECT_EQ(rotation(Vec3::Zero()).coeffs(), Eigen::Quaterniond::Identity().coeffs());
}

// A length whose square is zero is lost; any that is longer is kept to rounding.
TEST(RotationVector, OfASmallRotationKeepsItsLength) {
  for (const double angle : {1e-3, 1e-9, 1e-100}) {
    const Vec3 vector(angle, 0.0, 0.0);
    EXPECT_NEAR(rotationVector(rotation(vector)).x(), angle, 1e-15 * angle);
  }
}

TEST(RotationVector, WayBetweenOrientationsIsDividedEvenly) {
  RandomStream random(2, 0);
  for (int draw = 0; draw < 200; ++draw) {
    const Eigen::Quaterniond from = rotation(drawn(random, 3.0 * random.uniform()));
    const Eigen::Quaterniond to = rotation(drawn(random, 3.0 * random.uniform()));
    EXPECT_NEAR(angleBetween(from, to), from.angularDistance(to), 1e-7);  // Eigen's is less accurate for small angles
    const double share = random.uniform();
    const Eigen::Quaterniond between = orientationBetween(from, to, share);
    EXPECT_NEAR(angleBetween(from, between), share * angleBetween(from, to), 10.0 * kRounding);
    EXPECT_LT(1.0 - std::abs(between.dot(from.slerp(share, to))), 10.0 * kRounding);
  }
}

}  // namespace
}  // namespace springtower
