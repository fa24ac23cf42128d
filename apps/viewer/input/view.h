#pragma once

#include "apps/viewer/input/camera.h"

namespace springtower {

// How the camera goes along with a block. All are functions of the camera and of poses.

/// The azimuth nearest to a camera's from which a horizontal line lies across the picture, rad.
double squareTo(const Camera& camera, const Vec3& line);

/// The camera that shows a held block: at it, but no farther from what `home` shows than needed; no farther away than
/// kHeldDistance_m; between kLowestHeld and kHighestHeld above the horizon, or at kHighestHeld at least where it is carried and
/// places are to be seen from above; and from the given azimuth.
Camera viewOfHeld(const Camera& home, double azimuth, const Vec3& block, bool carried);

inline constexpr double kHeldDistance_m = 0.85;
inline constexpr double kLowestHeld = 0.2094;   ///< rad, 12 degrees
inline constexpr double kHighestHeld = 0.4887;  ///< rad, 28 degrees

/// Eases a camera to a goal: 95 % of the way in kEase_s, the shorter way round.
void ease(Camera& camera, const Camera& goal, double elapsed_s);

inline constexpr double kEase_s = 0.35;

/// Whether two cameras show the same to the eye: within a milliradian and half a millimetre.
bool showsTheSame(const Camera& a, const Camera& b);

}  // namespace springtower
