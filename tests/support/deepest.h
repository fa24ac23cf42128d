#pragma once

#include "solver/metrics/penetration.h"
#include "solver/world/simulation.h"
#include "tests/support/prepare_and_step.h"

#include <algorithm>

namespace springtower {

/// Steps so many frames; returns the deepest penetration at the end of any, m.
inline double deepestOver(int frames, Simulation& simulation) {
  PenetrationWorkspace workspace;
  double deepest_m = 0.0;
  for (int frame = 0; frame < frames; ++frame) {
    prepareAndStep(simulation);
    deepest_m = std::max(
        deepest_m, maxPenetration(simulation.state.position, simulation.scene.floor, workspace, simulation.model.fixed).depth);
  }
  return deepest_m;
}

}  // namespace springtower
