#include "solver/statics/friction_limit.h"

#include "core/scene/scene.h"
#include "core/state.h"

#include <cmath>
#include <gtest/gtest.h>
#include <numbers>
#include <vector>

namespace springtower {
namespace {

// A block on two points beside its centre, with `share` of its weight on one of them.
double limitOnTwoPoints(double share, const Vec3& direction) {
  const Simulation simulation(bitCodeScene("(010)"));
  const Vec3 middle = centre(simulation.state.position, 0);
  const double weight_n = simulation.model.mass[0] * simulation.scene.gravity.magnitude;
  std::vector<ContactForce> contacts;
  for (const double side : {1.0, -1.0}) {
    const Vec3 place = middle + side * 0.01 * Vec3::UnitY() - 0.009 * Vec3::UnitZ();
    contacts.push_back({blockId(0), kFloor, place, place, Vec3::UnitZ(), (side > 0.0 ? share : 1.0 - share) * weight_n,
                        Vec3::Zero(), 0.0, false});
  }
  return frictionLimit_n(simulation, contacts, blockId(0), direction) / (simulation.scene.staticFriction * weight_n);
}

// The polygon of a cone lies inside it, by no more than the cosine of half an angle between its corners.
const double kPolygon = std::cos(std::numbers::pi / 64.0);

TEST(FrictionLimit, OfEqualLoadsIsFrictionTimesTheirSum) {
  EXPECT_NEAR(limitOnTwoPoints(0.5, Vec3::UnitX()), 1.0, 1e-6);
  const double askew = limitOnTwoPoints(0.5, Vec3(std::cos(0.3), std::sin(0.3), 0.0));
  EXPECT_LE(askew, 1.0 + 1e-6);
  EXPECT_GE(askew, kPolygon - 1e-6);
}

// Pulled perpendicular to the line of its points it rotates about the one with the larger load: the limit is twice that of the
// weaker one.
TEST(FrictionLimit, OfUnequalLoadsIsThatOfATurn) {
  EXPECT_NEAR(limitOnTwoPoints(0.75, Vec3::UnitX()), 0.5, 1e-6);
  EXPECT_NEAR(limitOnTwoPoints(0.9, -Vec3::UnitX()), 0.2, 1e-6);
}

// Along the line of its points it cannot rotate.
TEST(FrictionLimit, AlongTheLineOfItsPointsIsFrictionTimesTheirSum) {
  EXPECT_NEAR(limitOnTwoPoints(0.75, Vec3::UnitY()), 1.0, 1e-6);
}

}  // namespace
}  // namespace springtower
