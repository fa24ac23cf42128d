#pragma once

#include "tests/support/block_scenes.h"

namespace springtower {

/// A scene simulated with the 2003 report's method and inertia, without sleep.
inline Scene asReported(Scene scene, Inertia inertia = Inertia::lumped) {
  scene.settings.method = Method::report;
  scene.settings.inertia = inertia;
  scene.settings.sleep = Sleep::off;
  return scene;
}

/// A scene with its tolerance and this many steps a frame.
inline Scene withSubsteps(Scene scene, int substeps) {
  scene.settings.substeps = substeps;
  scene.settings.tolerance_m = toleranceOf(scene);
  return scene;
}

}  // namespace springtower
