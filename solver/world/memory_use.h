#pragma once

#include "solver/world/simulation.h"

#include <cstddef>

namespace springtower {

/// Bytes that a running scene holds, by purpose; without spare capacity.
struct MemoryUse {
  std::size_t state = 0;     ///< what moves: positions and velocities, sleep and rest times
  std::size_t model = 0;     ///< what does not move: the scene's blocks, dimensions, masses, springs
  std::size_t contacts = 0;  ///< near pairs, and the points of those that touch
  std::size_t factor = 0;    ///< matrices of the implicit method and their factors
  std::size_t working = 0;   ///< forces, frames, boxes, islands, and the checkpoint of the frame

  // Of the contacts, by pair.
  std::size_t nearPairs = 0;
  std::size_t touchingPairs = 0;  ///< including pairs that have just separated
  std::size_t pairs = 0;          ///< bytes of the pair table and of every list with one entry a pair
  std::size_t touching = 0;       ///< bytes that touching pairs add in the contact pool
  std::size_t touchingSteps = 0;  ///< and for their step and frame: trial points and checkpoint rows
  [[nodiscard]] std::size_t total() const { return state + model + contacts + factor + working; }
};

/// Counts the bytes of a scene as it is now.
MemoryUse memoryUse(const Simulation& simulation);

}  // namespace springtower
