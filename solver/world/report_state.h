#pragma once

#include "core/state.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace springtower {

// What method `report` stores beside the state: the collisions of its last step, which are all that its friction uses of contacts
// (report 4.6), and working space of its collision loop.

/// A collision between a few corners of one block and a few of another, or of the floor: a corner and a face (1 and 3 corners),
/// two edges (2 and 2), a corner and the floor (1 and 0). The weights of either side sum up to 1 (report Eq. 4.14 to 4.16).
struct ReportContact {
  std::int32_t first = -1;
  std::int32_t second = -1;  ///< -1: the floor
  std::int8_t firstCount = 0;
  std::int8_t secondCount = 0;
  std::array<std::int8_t, 4> corner{};  ///< those of the first block, then those of the second
  std::array<double, 4> weight{};
  Vec3 normal = Vec3::UnitZ();  ///< unit, from the second to the first
  double impulse = 0.0;         ///< N s, on the first along the normal, summed over the step's passes; > 0
};

struct ReportState {
  /// Collisions of the last step, [blocks]: each in the list of one of its awake blocks, so that islands never share a list.
  std::vector<std::vector<ReportContact>> contacts;
  std::vector<std::vector<std::int32_t>> struck;  ///< disabled blocks that each awake one has hit hard in this frame, [blocks]
  ParticleArray from;  ///< m; straight paths of the step, extended a little beyond both ends of the step
  ParticleArray to;
  ParticleArray low;  ///< m; the box that each corner sweeps
  ParticleArray high;
  std::vector<std::uint32_t> version;  ///< incremented whenever a block's path changes, [blocks]
  std::vector<std::array<std::uint32_t, 2>>
      testedAt;  ///< versions of a pair's blocks when it was last found free of collisions, by position in the pairs

  void resize(std::size_t blocks) {
    contacts.resize(blocks);
    struck.resize(blocks);
    from.resize(blocks);
    to.resize(blocks);
    low.resize(blocks);
    high.resize(blocks);
    version.assign(blocks, 0);
  }
};

}  // namespace springtower
