#pragma once

namespace springtower {

// Sizes by which contacts are judged, in heights of the scene's lowest block, so that any size of block works unchanged.

/// The scene's own scale, and the sizes above in metres.
struct Lengths {
  double blockHeight_m = 0.0;  ///< h, least side of any block
  double fallTime_s = 0.0;     ///< sqrt(h / g), in which times are measured; without gravity with that of Earth
  double contactError_m = 0.0;
  double partingGap_m = 0.0;
};

}  // namespace springtower
