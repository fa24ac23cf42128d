#pragma once

#include "core/ids.h"
#include "core/vector.h"
#include "solver/world/contact_pool.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace springtower {

/// The pairs of near blocks a < b (or block a and the floor, b = -1), by (a, b), the floor first for each a; structure of arrays.
/// A pair is kept as long as its swept boxes overlap: how it touches, and until how much travel that need not be looked at again.
struct PairTable {
  std::vector<BlockPair> key;
  std::vector<PairPhase> phase;
  std::vector<std::int32_t> contact;        ///< of those that touch; of those that have parted in this frame too; else -1
  std::vector<double> clearance;            ///< m, of separated pairs: their gap along the axis when last measured
  std::vector<double> travelAtCheck;        ///< m, sum of both blocks' travel when last looked at
  std::array<std::vector<double>, 3> axis;  ///< of separated pairs: a direction that separated them last, unit, from b to a

  static constexpr std::size_t kBytes =
      sizeof(BlockPair) + sizeof(PairPhase) + sizeof(std::int32_t) + 5 * sizeof(double);  ///< a pair

  [[nodiscard]] std::size_t size() const { return key.size(); }
  /// A pair as functions on one pair take it.
  [[nodiscard]] PairOfBlocks operator[](std::size_t at) const { return {key[at].a, key[at].b, phase[at]}; }
  [[nodiscard]] bool touches(std::size_t at) const { return phase[at] != PairPhase::separated; }
  [[nodiscard]] Vec3 axisOf(std::size_t at) const { return {axis[0][at], axis[1][at], axis[2][at]}; }
  void setAxis(std::size_t at, const Vec3& direction) {
    for (std::size_t k = 0; k < 3; ++k) axis[k][at] = direction[static_cast<Eigen::Index>(k)];
  }
};

}  // namespace springtower
