#pragma once

#include "core/ids.h"
#include "core/vector.h"
#include "solver/world/contact_pool.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace springtower {

/// The pairs of near blocks a < b (or block a and the floor, b = -1), sorted by (a, b), the floor first for each a; structure of
/// arrays. A pair exists as long as its swept boxes overlap, and stores its phase and the travel up to which it need not be
/// checked again.
struct PairTable {
  std::vector<BlockPair> key;
  std::vector<PairPhase> phase;
  std::vector<std::int32_t> contact;        ///< of touching pairs, and of those that separated in this frame; otherwise -1
  std::vector<double> clearance;            ///< m, of separated pairs: gap along the axis when last measured
  std::vector<double> travelAtCheck;        ///< m, sum of both blocks' travel at the last check
  std::array<std::vector<double>, 3> axis;  ///< of separated pairs: the last separating direction, unit, from b to a

  static constexpr std::size_t kBytes =
      sizeof(BlockPair) + sizeof(PairPhase) + sizeof(std::int32_t) + 5 * sizeof(double);  ///< a pair

  [[nodiscard]] std::size_t size() const { return key.size(); }
  /// A pair in the form that functions on one pair take.
  [[nodiscard]] PairOfBlocks operator[](std::size_t at) const { return {key[at].a, key[at].b, phase[at]}; }
  [[nodiscard]] bool touches(std::size_t at) const { return phase[at] != PairPhase::separated; }
  [[nodiscard]] Vec3 axisOf(std::size_t at) const { return {axis[0][at], axis[1][at], axis[2][at]}; }
  void setAxis(std::size_t at, const Vec3& direction) {
    for (std::size_t k = 0; k < 3; ++k) axis[k][at] = direction[static_cast<Eigen::Index>(k)];
  }
};

}  // namespace springtower
