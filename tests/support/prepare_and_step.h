#pragma once

#include "solver/frame/prepare.h"
#include "solver/world/simulation.h"

namespace springtower {

/// A frame, and before the first one the search for the equilibrium: for tests of what comes after it.
inline void prepareAndStep(Simulation& simulation) {
  prepare(simulation);
  stepFrame(simulation);
}

}  // namespace springtower
