#include "tests/pinned/pinned_scene.h"
#include "tests/support/block_scenes.h"

#include <cctype>

namespace springtower {
namespace {

// Something of everything in few blocks: a stack that sways, a block that is pushed along under others, and one that lands on top
// with a corner first.
Scene sampler() {
  Scene scene = swaying(awake(bitCodeScene("(101)-(111)-(101)")), 0.5, 2.0);
  scene.forces.push_back(constantForce(3, -1, Vec3(0.0, 0.2, 0.0), 0.1, 0.3));
  BlockSpec falling;
  falling.centre = Vec3(0.005, 0.0, 3.0 * kBlockHeight_m + 0.025);
  falling.orientation = Eigen::Quaterniond(0.99, 0.06, 0.04, 0.02).normalized();
  scene.blocks.push_back(falling);
  return scene;
}

PinnedScene withSettings(const char* name, Settings (*change)(Settings)) {
  return {name, 60, [=] {
            Scene scene = sampler();
            scene.settings = change(scene.settings);
            return scene;
          }};
}

// A force of thirty weights on a corner, which strains a block by more than explicit steps let it be
// (docs/adr/0025-strain-limit.md).
Scene pulledByACorner(Method method) {
  Scene scene = bitCodeScene("(111)-(010)");
  scene.settings.method = method;
  scene.settings.tolerance_m = 5e-4;
  const double weight_n = kStandardGravity_m_s2 * scene.blocks[3].mass;
  scene.forces.push_back(constantForce(3, 5, 30.0 * weight_n * Vec3(0.48, 0.6, 0.64), 0.0, 0.2));
  return scene;
}

// "semi-implicit-euler" as "MethodSemiImplicitEuler".
std::string pinNameOf(Method method) {
  std::string name = "Method";
  bool begins = true;
  for (const char letter : nameOf(method)) {
    if (letter != '-') name += begins ? static_cast<char>(std::toupper(static_cast<unsigned char>(letter))) : letter;
    begins = letter == '-';
  }
  return name;
}

}  // namespace

std::vector<PinnedScene> pinnedMethods() {
  std::vector<PinnedScene> scenes;
  for (const Method method :
       {Method::implicit, Method::implicitEuler, Method::implicitEigen, Method::semiImplicitEuler, Method::midpoint,
        Method::rungeKutta4, Method::report, Method::rigidPgs, Method::rigidLcp, Method::xpbd, Method::automatic}) {
    scenes.push_back({pinNameOf(method), 60, [=] {
                        Scene scene = sampler();
                        scene.settings.method = method;
                        return scene;
                      }});
  }
  const auto add = [&](const char* name, Settings (*change)(Settings)) { scenes.push_back(withSettings(name, change)); };
  scenes.push_back({"StrainLimitOfEuler", 30, [] { return pulledByACorner(Method::semiImplicitEuler); }});
  scenes.push_back({"StrainLimitOfRungeKutta", 30, [] { return pulledByACorner(Method::rungeKutta4); }});
  add("LumpedInertia", [](Settings s) { return s.inertia = Inertia::lumped, s; });
  add("FixedSubsteps", [](Settings s) { return s.substeps = 200, s.method = Method::semiImplicitEuler, s; });
  add("WithoutContinuousTests", [](Settings s) { return s.continuousTests = false, s; });
  add("FineTolerance", [](Settings s) { return s.tolerance_m = 1e-5, s; });
  add("SoftAndUndamped", [](Settings s) { return s.tolerance_m = 2e-4, s.stiffnessDamping = 0.0, s.maxwellRatio = 0.0, s; });
  add("LongFrames", [](Settings s) { return s.frame_s = 1.0 / 30.0, s; });
  return scenes;
}

}  // namespace springtower
