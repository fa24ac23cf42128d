#pragma once

#include "solver/world/simulation.h"

#include <iosfwd>

namespace springtower {

/// Writes poses as CSV: time_s, block from 0, then x, y, z of corners 0 to 7 (core/block.h), metres. The start is written, and
/// then every frame that is nearest to a multiple of the interval; every frame when the interval is shorter than one.
class PoseWriter {
 public:
  /// Writes the line of names. The stream outlives the writer; `every_s` and `frame_s` are positive.
  PoseWriter(std::ostream& stream, double every_s, double frame_s);

  /// Call for the start and for every frame, in order.
  void frame(const Simulation& simulation);

 private:
  std::ostream& stream_;
  double every_s_;
  double half_s_;       // of a frame
  double written_ = 0;  // multiples of the interval so far
};

}  // namespace springtower
