// Blocks that fall and hit one another gain no energy.
#include "core/scene/scene.h"
#include "scenarios/registry.h"
#include "solver/world/simulation.h"
#include "tests/support/prepare_and_step.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <gtest/gtest.h>

namespace springtower {
namespace {

// Rises of the energy over that at the start: the largest in one frame, and the largest above any value before.
struct Rises {
  double inAFrame = 0.0;
  double ever = 0.0;
};

Rises risesOf(const Scene& scene, int frames) {
  Simulation simulation(scene);
  const Energy start = energy(simulation);
  double last_j = start.total();
  double least_j = last_j;
  Rises rises;
  for (int frame = 0; frame < frames; ++frame) {
    prepareAndStep(simulation);
    const double now_j = energy(simulation).total();
    rises.inAFrame = std::max(rises.inAFrame, (now_j - last_j) / (start.kinetic + start.gravity));
    rises.ever = std::max(rises.ever, (now_j - least_j) / (start.kinetic + start.gravity));
    last_j = now_j;
    least_j = std::min(least_j, now_j);
  }
  return rises;
}

// Without friction, a point that no longer pushes has no impulse left. 1e-6 of the energy is the required bound where nothing is
// pushed apart.
TEST(ImpactEnergy, DoesNotRiseWithoutFriction) {
  for (const char* name : {"heap:3", "heap:8", "heap:25"}) {
    Scene scene = sceneNamed(name);
    scene.staticFriction = scene.kineticFriction = 0.0;
    scene.settings.sleep = Sleep::off;
    EXPECT_LE(risesOf(scene, 120).ever, 1e-6) << name;
  }
}

// A heavy cube falls on a block that lies on the floor: the floor's push in the impact ends with the impact; a push that is too
// large, as so unlike masses take many passes to find it, lifts nothing and speeds nothing up; and implicit steps gain nothing
// where the cube rocks.
// The bounds are what is allowed where blocks are pushed apart, in a frame and over a run.
TEST(ImpactEnergy, DoesNotRiseWhereAHeavyBlockFallsOnALightOne) {
  for (const double ratio : {10.0, 30.0, 100.0, 1000.0, 2000.0, 5000.0}) {
    for (const double tilt_rad : {0.0, 0.02, 0.03, 0.05, 0.08, 0.09, 0.16, 0.17, 0.18, 0.23, 0.3, 0.335, 0.36, 0.38}) {
      Scene scene;
      scene.settings.sleep = Sleep::off;
      BlockSpec light;
      light.centre.z() = 0.5 * kBlockHeight_m;
      BlockSpec heavy;
      heavy.dimensions = {0.1, 0.1, 0.1};
      heavy.mass = ratio * kBlockMass_kg;
      heavy.centre = {0.02, 0.005, kBlockHeight_m + 0.15};
      heavy.orientation = Eigen::AngleAxisd(tilt_rad, Vec3(1.0, 0.7, 0.0).normalized());
      scene.blocks = {light, heavy};
      SCOPED_TRACE(testing::Message() << ratio << " times the mass, " << tilt_rad << " rad");
      const Rises rises = risesOf(scene, 90);
      EXPECT_LE(rises.inAFrame, 1e-4);
      EXPECT_LE(rises.ever, 1e-3);
    }
  }
}

}  // namespace
}  // namespace springtower
