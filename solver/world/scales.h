#pragma once

#include "solver/world/simulation.h"

#include <algorithm>
#include <cmath>

namespace springtower {

// What thresholds of times and speeds are multiples of. `Lengths::fallTime_s` is sqrt(h / g) too, but with the Earth's gravity
// where a scene has none: it scales the constants of contacts, which have to be finite.

/// sqrt(h / g), s; without gravity so long that nothing is at rest for as long.
inline double restTimeScale_s(const Simulation& simulation) {
  return std::sqrt(simulation.lengths.blockHeight_m / std::max(simulation.scene.gravity.magnitude, 1e-9));
}

/// sqrt(g h), m/s; 0 without gravity.
inline double speedScale_m_s(const Simulation& simulation) {
  return std::sqrt(simulation.lengths.blockHeight_m * simulation.scene.gravity.magnitude);
}

}  // namespace springtower
