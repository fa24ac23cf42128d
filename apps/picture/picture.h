#pragma once

#include "core/state.h"

#include <iosfwd>

namespace springtower {

/// How a picture looks.
struct PictureOptions {
  int pixels = 1000 * 1000;     ///< about this many; the picture is as wide and high as the blocks need
  double azimuth_deg = -52.0;   ///< where the camera stands, from +x over +y: bit codes read left to right on both visible faces
  double elevation_deg = 18.0;  ///< above the horizon
};

/// Draws the blocks as a PNG: in perspective, in the colours of wood, lit from the upper left with shadows, and with a floor
/// marked in squares of 2 cm (or as many times that as the scene needs). Blocks far from all others may lie outside. A stream
/// that takes no more is left failed. Precondition: at least one block, finite positions.
void writePicture(std::ostream& stream, const ParticleArray& position, bool floor, const PictureOptions& options = {});

}  // namespace springtower
