#pragma once

#include "solver/metrics/measures.h"
#include "solver/world/simulation.h"

#include <cstddef>
#include <functional>
#include <vector>

namespace springtower {

// Trials that a real tower could be put to as well: driven from outside, frame by frame. Used alike by tests and `validate`.

/// What a block has slipped when it has moved this far against everything that it touches, m, for blocks of the game's height;
/// others in proportion. Surfaces move against one another where they touch, whatever the centres do: a block that is drawn by
/// its end turns.
inline constexpr double kFirstSlip_m = 5e-5;

/// What came of pulling a block until it slips.
struct SlipTrial {
  bool slipped = false;   ///< before half as much again as its friction bears was reached
  double force_n = 0.0;   ///< in the frame in which it had slipped
  double normal_n = 0.0;  ///< sum of the normal forces of all its contacts, in the frame before
  double limit_n = 0.0;   ///< the largest force that friction bears at the normal forces of all contacts there were then
  double time_s = 0.0;    ///< since the pull began
};

/// Pulls a block at its centre along a unit direction with a force that grows slowly (1 % of what its friction bears a
/// second, the first nine tenths in 1.5 s) until it has slipped by kFirstSlip_m. Replaces the forces of the simulation's scene
/// and takes them away at the end. The block should be at rest. `afterFrame` is called after every frame, where there is one;
/// what it throws ends the trial.
SlipTrial pullUntilSlip(Simulation& simulation, std::size_t block, const Vec3& direction,
                        const std::function<void()>& afterFrame = {});

/// How gravity is turned in `tiltUntilFall`.
struct TiltRamp {
  double direction_deg = 0.0;   ///< towards which side, from +x over +y
  double start_deg = 0.0;       ///< from straight down; reached at `approach_deg_s`, then held for `hold_s`
  double approach_deg_s = 2.0;  ///< degrees a second; a tower that starts near its limit would be toppled by its own first sag
  double hold_s = 1.0;          ///< s
  double rate_deg_s = 0.1;      ///< degrees a second
  double most_deg = 90.0;       ///< where to give up
};

/// What came of it.
struct TiltTrial {
  bool fell = false;
  double tilt_deg = 0.0;  ///< of gravity when the scene had fallen, or at the end
  Standing standing;      ///< and what fell first
};

/// Turns a scene's gravity frame by frame until the scene does not stand any more. `afterFrame` as above. Throws DivergenceError.
TiltTrial tiltUntilFall(Scene scene, const TiltRamp& ramp, const std::function<void()>& afterFrame = {});

/// The same scene of blocks `size` times as large and `density` times as dense, its frames and its duration longer by the root of
/// the size, as all times are that gravity sets. Preconditions: both positive; no start gap, velocities or forces.
Scene scaled(Scene scene, double size, double density);

/// Sum over a block's contacts of the normal force, N: of all, or of those from above only.
double normalForceOn(const std::vector<ContactForce>& forces, BlockId block, bool fromAboveOnly);

}  // namespace springtower
