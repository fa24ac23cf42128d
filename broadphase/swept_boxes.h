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

/// Where blocks may get to: onwards along their velocity, where what they hit stops them or pushes them on; or to any side, where
/// they may rebound.
enum class Way : std::uint8_t { onwards, anySide };

/// Computes, for each listed block, a box that its corners do not leave before it has moved by its reach (m): that of its present
/// corners, going onwards moved along the velocity of its centre for `duration_s`, and grown on every side by
///   reach = speed duration + gravity duration^2 / 2 + margin,
/// with the speed of its fastest corner, going onwards about its centre. The margin allows for what contacts and springs add. A
/// block about to sleep has duration 0: its present box, grown by the margin. Other blocks keep their boxes and reaches.
/// `gravity` in m/s2, `duration_s` and `margin_m`, [blocks], not negative; boxes and reach are [blocks]. The reach of a
/// block whose state is not finite is NaN, and so is its box.
void computeSweptBoxes(const MotionState& state, std::span<const std::int32_t> blocks, double gravity, double duration_s, Way way,
                       std::span<const double> margin_m, SweptBoxes& boxes, std::span<double> reach);

}  // namespace springtower
