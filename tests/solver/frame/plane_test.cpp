// Scenes of rectangles: the constraint of motion to a plane, and the report's two prototypes in it.
#include "core/error.h"
#include "core/scene/scene.h"
#include "solver/metrics/measures.h"
#include "solver/metrics/penetration.h"
#include "tests/support/block_scenes.h"
#include "tests/support/prepare_and_step.h"
#include "tests/support/says.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <string>

namespace springtower {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

Scene prototype(Method method) {
  Scene scene = sceneFromToml(std::string(SPRINGTOWER_SOURCE_DIR) + "/scenes/prototypes.toml");
  scene.settings.method = method;
  scene.settings.sleep = Sleep::off;
  return scene;
}

// Largest distance of any corner from the mirror image, in the plane y = 0, of its partner across a block's second axis.
double asymmetry(const ParticleArray& position) {
  double largest = 0.0;
  for (std::size_t b = 0; b < position.blockCount(); ++b) {
    for (const std::size_t c : {0U, 1U, 4U, 5U}) {
      Vec3 image = position.at(b, c | 2U);
      image.y() = -image.y();
      largest = std::max(largest, (position.at(b, c) - image).norm());
    }
  }
  return largest;
}

struct Outcome {
  double meanPenetration_m = 0.0;  // deepest of each frame of the last half second, mean
  double strain = 0.0;             // largest of the same
  double asymmetry_m = 0.0;
  bool atRest = false;    // at the end, by the rule for sleep
  double lowest_m = 0.0;  // centre of the lower row's blocks at the end
};

Outcome outcomeOf(const Scene& scene) {
  Simulation simulation(scene);
  stepFor(simulation, 4.5);
  Outcome outcome;
  PenetrationWorkspace workspace;
  constexpr int kFrames = 30;
  for (int frame = 0; frame < kFrames; ++frame) {
    prepareAndStep(simulation);
    const ParticleArray& position = simulation.state.position;
    outcome.meanPenetration_m += maxPenetration(position, true, workspace).depth / kFrames;
    outcome.strain = std::max(outcome.strain, maxStrain(simulation.model, position));
    outcome.asymmetry_m = std::max(outcome.asymmetry_m, asymmetry(position));
  }
  outcome.atRest = atRest(simulation);
  outcome.lowest_m = std::min(centre(simulation.state.position, 0).z(), centre(simulation.state.position, 1).z());
  return outcome;
}

// Report Figure 3.2: "the collision routine could not be time limited". Pivoting brings the stack to rest, in the plane.
TEST(Prototypes, RigidRectanglesComeToRest) {
  const Outcome rigid = outcomeOf(prototype(Method::rigidLcp));
  EXPECT_LT(rigid.meanPenetration_m, 5e-4);
  EXPECT_LT(rigid.strain, 1e-9) << "rigid";
  EXPECT_LT(rigid.asymmetry_m, 1e-12);
  EXPECT_TRUE(rigid.atRest);
  EXPECT_NEAR(rigid.lowest_m, 0.5 * kBlockHeight_m, 5e-4);
}

// Report Figure 3.4: "deformation was barely noticeable". A row is compressed by no more than the tolerance. With a fixed number
// of steps a frame, as in the report, and with as many as the tolerance requires.
TEST(Prototypes, SprungRectanglesComeToRest) {
  for (const int substeps : {100, 0}) {
    Scene scene = prototype(Method::semiImplicitEuler);
    scene.settings.substeps = substeps;
    scene.settings.tolerance_m = toleranceOf(scene);
    const Outcome sprung = outcomeOf(scene);
    const double tolerance_m = kBlockTolerance_m;
    EXPECT_LT(sprung.meanPenetration_m, tolerance_m);
    EXPECT_LT(sprung.strain, tolerance_m / kBlockHeight_m);
    EXPECT_LT(sprung.asymmetry_m, 1e-12);
    EXPECT_TRUE(sprung.atRest) << substeps << " steps";
    EXPECT_NEAR(sprung.lowest_m, 0.5 * kBlockHeight_m, tolerance_m);
  }
}

// A kick across the plane moves nothing; the same kick moves the same stack if the scene is not restricted to the plane.
TEST(Plane, NothingLeavesIt) {
  for (const Method method : {Method::implicit, Method::midpoint, Method::rigidPgs}) {
    Scene scene = prototype(method);
    const auto across = [&] {
      Simulation simulation(scene);
      prepareAndStep(simulation);
      kick(simulation, 0, Vec3(0.0, 0.5, 0.0));
      stepFor(simulation, 0.1);
      return std::abs(centre(simulation.state.position, 0).y());
    };
    EXPECT_LT(across(), 1e-15);
    scene.plane = false;
    EXPECT_GT(across(), 1e-3);
  }
}

TEST(Plane, RefusesScenesThatAreNotInIt) {
  const auto refusal = [](const auto& change) {
    Scene scene = oneBlockScene(true);
    scene.plane = true;
    checkScene(scene, "s");
    change(scene);
    return [scene] { checkScene(scene, "s"); };
  };
  EXPECT_THAT(refusal([](Scene& s) { s.blocks[0].centre.y() = 0.01; }),
              ThrowsMessage<InputError>(says("s: block 0: centre y: expected ..., got 0.01")));
  EXPECT_THAT(refusal([](Scene& s) { s.blocks[0].spin.z() = 1.0; }),
              ThrowsMessage<InputError>(says("spin z: expected ..., got 1")));
  EXPECT_THAT(refusal([](Scene& s) { s.blocks[0].velocity.y() = 1.0; }),
              ThrowsMessage<InputError>(says("velocity y: expected ..., got 1")));
  EXPECT_THAT(refusal([](Scene& s) { s.blocks[0].orientation = Eigen::AngleAxisd(0.1, Vec3::UnitZ()); }),
              ThrowsMessage<InputError>(HasSubstr("turn out of the plane")));
  EXPECT_THAT(refusal([](Scene& s) { s.gravity.tilt_deg = s.gravity.direction_deg = 30.0; }),
              ThrowsMessage<InputError>(HasSubstr("gravity: y")));
  EXPECT_THAT(refusal([](Scene& s) { s.forces.push_back(constantForce(0, -1, Vec3::UnitY(), 0.0, 1.0)); }),
              ThrowsMessage<InputError>(says("force 0: force y: expected ..., got 1")));
  EXPECT_THAT(refusal([](Scene& s) { s.forces.push_back(constantForce(0, 3, Vec3::UnitX(), 0.0, 1.0)); }),
              ThrowsMessage<InputError>(HasSubstr("force 0: corner")));
}

}  // namespace
}  // namespace springtower
