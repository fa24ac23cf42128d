#pragma once

#include "solver/frame/prepare.h"
#include "solver/metrics/measures.h"
#include "solver/world/simulation.h"

#include <cstddef>
#include <functional>
#include <vector>

namespace springtower {

// Experiments that could be made with a real tower as well: controlled from outside, frame by frame. Used by tests and
// `validate`.

/// Displacement of a block relative to everything that it touches from which it counts as slipped, m, for blocks of the game's
/// height; for others in proportion. It is measured at the contacts rather than at the centres, because a block that is drawn by
/// its end rotates.
inline constexpr double kFirstSlip_m = 5e-5;

/// Result of pulling a block until it slips.
struct SlipTrial {
  bool slipped = false;   ///< before the force reached 1.5 times the friction limit of the start
  double force_n = 0.0;   ///< in the frame in which it slipped
  double normal_n = 0.0;  ///< sum of the normal forces of all its contacts in the frame before
  double limit_n = 0.0;   ///< friction limit at the normal forces of all contacts in that frame (frictionLimit_n)
  double time_s = 0.0;    ///< since the pull began
};

/// Pulls a block at its centre along a unit direction with a slowly increasing force (1 % of its friction limit a second, after
/// the first nine tenths in 1.5 s) until it has slipped by kFirstSlip_m. Replaces the forces of the simulation's scene and
/// removes them at the end. The block should be at rest. `afterFrame` is called after every frame, where there is one; what it
/// throws ends the trial.
SlipTrial pullUntilSlip(Simulation& simulation, std::size_t block, const Vec3& direction,
                        const std::function<void()>& afterFrame = {});

/// How gravity is rotated in `tiltUntilFall`.
struct TiltRamp {
  double direction_deg = 0.0;   ///< side towards which it tilts, from +x over +y
  double start_deg = 0.0;       ///< from straight down; reached at `approach_deg_s`, then held for `hold_s`
  double approach_deg_s = 2.0;  ///< degrees a second; starting at the tilt would topple a tower near its limit by its first sag
  double hold_s = 1.0;          ///< s
  double rate_deg_s = 0.1;      ///< degrees a second
  double most_deg = 90.0;       ///< end of the ramp
};

/// Result of a tilt ramp.
struct TiltTrial {
  bool fell = false;
  double tilt_deg = 0.0;  ///< of gravity when the scene had fallen, or at the end
  Standing standing;      ///< and what fell first
};

/// Rotates a scene's gravity frame by frame until the scene does not stand any more. `afterFrame` as above, and after the search
/// for the equilibrium, which `search` is for. Throws DivergenceError.
TiltTrial tiltUntilFall(Scene scene, const TiltRamp& ramp, const std::function<void()>& afterFrame = {},
                        const PrepareOptions& search = {});

/// The same scene with blocks `size` times as large and `density` times as dense, and its frames and duration scaled by the root
/// of the size, like all times under gravity. Preconditions: both positive; no start gap, velocities or forces.
Scene scaled(Scene scene, double size, double density);

/// Sum over a block's contacts of the normal force, N: of all, or of those from above only.
double normalForceOn(const std::vector<ContactForce>& forces, BlockId block, bool fromAboveOnly);

}  // namespace springtower
