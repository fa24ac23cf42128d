#pragma once

#include "core/state.h"
#include "core/vector.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace springtower {

/// Axis-aligned boxes, m: block b spans lower[axis][b] to upper[axis][b].
struct SweptBoxes {
  std::array<AlignedVector<double>, 3> lower;
  std::array<AlignedVector<double>, 3> upper;

  void resize(std::size_t blocks) {
    for (auto& values : lower) values.resize(blocks);
    for (auto& values : upper) values.resize(blocks);
  }
  [[nodiscard]] std::size_t blockCount() const { return lower[0].size(); }
};

/// Computes, for each listed block, the bounding box of its present corners, grown on every side by its reach: the distance (m)
/// that any of its corners may travel before one can be outside,
///   reach = speed duration + gravity duration^2 / 2 + margin,
/// with the speed of its fastest corner. The margin allows for the effect of contacts and springs. A block about to sleep has
/// duration 0: its present box, grown by the margin. Other blocks keep their boxes and reaches. `gravity` in m/s2, `duration_s`
/// and `margin_m` not negative; boxes and reach are [blocks]; the blocks' state is finite.
void computeSweptBoxes(const MotionState& state, std::span<const std::int32_t> blocks, double gravity, double duration_s,
                       double margin_m, SweptBoxes& boxes, std::span<double> reach);

}  // namespace springtower
