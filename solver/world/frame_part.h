#pragma once

namespace springtower {

/// A part of a frame, s from the frame's beginning.
struct FramePart {
  double begin_s = 0.0;
  double end_s = 0.0;
  [[nodiscard]] double duration_s() const { return end_s - begin_s; }
};

}  // namespace springtower
