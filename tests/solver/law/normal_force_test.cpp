#include "core/scene/scene.h"
#include "solver/block/affine.h"
#include "solver/contact/query.h"
#include "solver/law/contact_force.h"
#include "solver/world/simulation.h"
#include "tests/support/block_scenes.h"

#include <gtest/gtest.h>

namespace springtower {
namespace {

constexpr double kImplicitStep_s = 1.0 / 240.0;
constexpr double kRestDepth_m = 2e-4;

// Normal force on a block that lies on the floor at a depth (m) and closes at a speed (m/s), N. `touched`: whether its points
// touched before the step, with a rest depth.
double forceAt(double depth_m, double closing_m_s, bool touched, const ContactStep& step) {
  Simulation simulation(blockOnSlopeScene(0.0, 0.0));
  ParticleArray& x = simulation.state.position;
  Manifold manifold;
  manifold.upper = 0;
  buildFloorManifold(cornersOf(x, 0), {1e-4, 1e-3}, manifold);
  for (std::size_t i = 0; i < kRowPoints; ++i) {
    PenaltyRow& row = manifold.points[0].penalty;
    row.touching[i] = touched ? 1.0 : 0.0;
    row.restDepth[i] = touched ? kRestDepth_m : 0.0;
    row.stiffening[i] = 1.0;
  }
  for (std::size_t c = 0; c < kCorners; ++c) x.add(0, c, Vec3(0.0, 0.0, -depth_m));
  AffineField motion{};
  motion.centre[2] = -closing_m_s;
  const BlockFrame frame = blockFrame(x, 0);
  PairForce force;
  manifoldForces(manifold, {&frame, &motion, &motion}, {}, contactLaw(simulation), step, kBlockMass_kg, nullptr, force);
  return force.upper.centre[2];
}

ContactStep implicitStep() {
  ContactStep step;
  step.advance_s = kImplicitStep_s;
  step.endOnly = true;
  return step;
}

// A Newton iteration finds no solution where the force jumps. A dashpot that acts with the whole closing speed where its spring
// begins to push would jump there by 0.2 weights of a block at 4 mm/s.
TEST(NormalForce, OfAnImplicitStepGrowsFromNothingWhereTheSpringBegins) {
  for (const bool touched : {false, true}) {
    const double begins_m = touched ? kRestDepth_m : 0.0;
    for (const double closing_m_s : {1e-3, 4e-3, 0.1}) {
      SCOPED_TRACE(testing::Message() << closing_m_s << " m/s" << (touched ? ", touched before" : ""));
      EXPECT_EQ(forceAt(begins_m - 1e-9, closing_m_s, touched, implicitStep()), 0.0);
      const double near = forceAt(begins_m + 1e-9, closing_m_s, touched, implicitStep());
      const double twice = forceAt(begins_m + 2e-9, closing_m_s, touched, implicitStep());
      EXPECT_GT(near, 0.0);
      EXPECT_NEAR(twice, 2.0 * near, 1e-6 * near) << "linear from the rest depth on";
    }
  }
}

// A point that has pushed all the while keeps its dashpot.
TEST(NormalForce, IsDampedByTheClosingSpeedWhereTheSpringHasPushedBefore) {
  const Simulation simulation(blockOnSlopeScene(0.0, 0.0));
  const ContactLaw law = contactLaw(simulation);
  constexpr double kElastic_m = 1e-5;
  const double closing_m_s = 0.5 * kElastic_m / kImplicitStep_s;
  const double depth_m = kRestDepth_m + kElastic_m;
  const double damped = forceAt(depth_m, closing_m_s, true, implicitStep()) - forceAt(depth_m, 0.0, true, implicitStep());
  EXPECT_NEAR(damped, 4.0 * law.stiffnessOf(0, -1) * law.dampingTime_s * closing_m_s, 1e-9 * damped);
}

}  // namespace
}  // namespace springtower
