#include "solver/block/static_shape.h"

#include "core/scene/scene.h"
#include "scenarios/registry.h"
#include "solver/block/inertia.h"
#include "solver/frame/prepare.h"
#include "solver/rigid/run.h"
#include "solver/world/simulation.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>

namespace springtower {
namespace {

double restCorner(const Simulation& simulation, std::size_t block, std::size_t axis, std::size_t corner) {
  return 0.5 * cornerSide(corner, axis) * simulation.model.dimensions[block][static_cast<Eigen::Index>(axis)];
}

// Implicit steps find the equilibrium of a tower. The strain of every block there, under the forces of its contacts, is that of
// the static shape to 2 %: the rest is of second order, or the residual of the contacts' forces.
TEST(StaticShape, IsThatOfABlockInEquilibrium) {
  Simulation simulation(sceneNamed("uneven:6"));
  prepare(simulation);
  for (int frame = 0; frame < 60; ++frame) stepFrame(simulation);
  double most = 0.0;
  double left = 0.0;
  for (std::size_t b = 0; b < simulation.model.blockCount(); ++b) {
    const Eigen::Matrix3d axes = straightAxes(simulation.state.position, b);
    const Vec3 middle = centre(simulation.state.position, b);
    Eigen::Matrix3d load = Eigen::Matrix3d::Zero();
    for (const ContactForce& contact : contactForcesOn(simulation, static_cast<BlockId>(b))) {
      const bool isUpper = static_cast<std::size_t>(contact.upper) == b;
      const Vec3 onUpper = contact.normalForce * contact.normal + contact.frictionForce;
      const Vec3 force = axes.transpose() * (isUpper ? onUpper : Vec3(-onUpper));
      const Vec3 arm = axes.transpose() * ((isUpper ? contact.point : contact.lowerPoint) - middle);
      load += arm * force.transpose();
    }
    OwnCorners shape;
    staticShape(staticResponse(simulation.model, simulation.scene.settings.inertia, b), simulation.model.dimensions[b], load,
                shape);
    for (std::size_t c = 0; c < kCorners; ++c) {
      const Vec3 own = axes.transpose() * (simulation.state.position.at(b, c) - middle);
      for (std::size_t a = 0; a < 3; ++a) {
        most = std::max(most, std::abs(own[static_cast<Eigen::Index>(a)] - restCorner(simulation, b, a, c)));
        left = std::max(left, std::abs(own[static_cast<Eigen::Index>(a)] - shape[a][c]));
      }
    }
  }
  EXPECT_GT(most, 1e-7);
  EXPECT_LT(left, 0.02 * most);
}

// Forces that only turn a block are those of its own inertia, m alpha x r: they leave its shape alone.
TEST(StaticShape, IsUndeformedUnderForcesThatOnlyTurn) {
  Simulation simulation(sceneNamed("tower:1"));
  const StaticResponse response = staticResponse(simulation.model, simulation.scene.settings.inertia, 0);
  const Vec3 angular(2.0, -3.0, 5.0);
  Eigen::Matrix3d load;
  for (Eigen::Index a = 0; a < 3; ++a) {
    const Vec3 turning = response.inertia[static_cast<std::size_t>(a)] * angular.cross(Vec3::Unit(a));
    load.row(a) = turning.transpose();
  }
  ASSERT_GT(load.norm(), 1e-6);
  OwnCorners shape;
  staticShape(response, simulation.model.dimensions[0], load, shape);
  for (std::size_t a = 0; a < 3; ++a) {
    for (std::size_t c = 0; c < kCorners; ++c) EXPECT_NEAR(shape[a][c], restCorner(simulation, 0, a, c), 1e-15);
  }
}

}  // namespace
}  // namespace springtower
