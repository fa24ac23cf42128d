#pragma once

namespace springtower {

// Lengths used to classify contacts, in heights of the scene's lowest block, so that the same values serve blocks of any size.

/// The scene's own length and time scale, and these lengths in metres.
struct Lengths {
  double blockHeight_m = 0.0;  ///< h, least side of any block
  double fallTime_s = 0.0;     ///< sqrt(h / g), the unit of times; without gravity, with that of Earth
  double contactError_m = 0.0;
  double partingGap_m = 0.0;
};

}  // namespace springtower
