#pragma once

#include "solver/world/simulation.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace springtower {

// What thresholds of times and speeds are multiples of. `Lengths::fallTime_s` is sqrt(h / g) too, but with the Earth's gravity
// where a scene has none: it scales the constants of contacts, which have to be finite.

/// sqrt(h / g), s; without gravity so long that nothing is at rest for as long.
inline double restTimeScale_s(const Simulation& simulation) {
  return std::sqrt(simulation.lengths.blockHeight_m / std::max(simulation.scene.gravity.magnitude, 1e-9));
}

/// Frames that a time takes, given in sqrt(h / g), or that of the Earth's gravity where there is none.
inline std::int32_t framesOf(const Simulation& simulation, double time) {
  return static_cast<std::int32_t>(std::ceil(time * simulation.lengths.fallTime_s / simulation.scene.settings.frame_s));
}

/// sqrt(g h), m/s; 0 without gravity.
inline double speedScale_m_s(const Simulation& simulation) {
  return std::sqrt(simulation.lengths.blockHeight_m * simulation.scene.gravity.magnitude);
}

}  // namespace springtower
