#pragma once

#include "solver/world/simulation.h"

#include <cstddef>

namespace springtower {

/// Bytes that a running scene holds, by what they are for; without spare capacity.
struct MemoryUse {
  std::size_t state = 0;     ///< what moves: positions and velocities, sleep and rest times
  std::size_t model = 0;     ///< what does not: dimensions, masses, springs
  std::size_t contacts = 0;  ///< near pairs with their manifolds and friction memory
  std::size_t factor = 0;    ///< matrices of the implicit method and their factors
  std::size_t working = 0;   ///< forces, frames, boxes, islands, and the copies that a frame which is run again starts from
  [[nodiscard]] std::size_t total() const { return state + model + contacts + factor + working; }
};

/// Counts the bytes of a scene as it is now.
MemoryUse memoryUse(const Simulation& simulation);

}  // namespace springtower
