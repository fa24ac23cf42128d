#include "core/scene/scene.h"
#include "core/tuning.h"
#include "scenarios/registry.h"
#include "solver/frame/prepare.h"
#include "solver/world/simulation.h"

#include <gtest/gtest.h>

namespace springtower {
namespace {

// Normal force of the floor after some frames, N.
double floorForce(const Scene& scene, int frames) {
  Simulation simulation(scene);
  prepare(simulation);
  for (int frame = 0; frame < frames; ++frame) stepFrame(simulation);
  double force_n = 0.0;
  for (const ContactForce& contact : contactForces(simulation)) {
    if (contact.lower == kFloor) force_n += contact.normalForce;
  }
  return force_n;
}

// Manifolds hold the forces of a frame's last step, with which the next frame starts, whether it is one of many or the only one
// (as in each part of a frame in parts). Without them blocks that others lie on sink a little in every frame.
TEST(StoredForces, AreThoseOfTheLastStepHoweverManyThereAre) {
  for (const int steps : {1, 2, 4}) {
    SCOPED_TRACE(testing::Message() << steps << " steps a frame");
    Scene scene = sceneNamed("tower:3");
    scene.settings.method = Method::rigidPgs;
    scene.settings.sleep = Sleep::off;
    scene.settings.substeps = steps * tuning::kSubstepsPerStep;
    const double weight_n = 9.0 * kBlockMass_kg * scene.gravity.magnitude;
    EXPECT_NEAR(floorForce(scene, 30), weight_n, 1e-3 * weight_n);
  }
}

}  // namespace
}  // namespace springtower
