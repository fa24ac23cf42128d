#pragma once

#include "apps/viewer/view/state.h"

namespace springtower {

// What a player sees of a fall: the clock stops, the picture goes back, and the last second passes again from the best side at a
// quarter of its speed, and goes on a little to where the blocks come down. Then the clock stops for good.

inline constexpr double kFallRate = 0.25;     ///< of its speed
inline constexpr double kFallBefore_s = 1.0;  ///< that is shown before the first block is down
inline constexpr double kFallAfter_s = 0.6;   ///< and after

/// Lets real time pass for a fall; begins when a game has just been lost in Mode::play. Returns whether the frames of the scene
/// have to wait meanwhile.
bool followFall(Viewer& viewer, double elapsed_s);

/// Shows the fall once more. Does nothing where there is none.
void watchFall(Viewer& viewer);

/// Leaves out the rest of the replay.
void skipFall(Viewer& viewer);

/// Ends it, as when the scene begins anew.
void endFall(Viewer& viewer);

/// Whether poses of the past are shown.
bool showsPast(const FallReplay& fall);

/// The poses that are shown then.
void pastPoses(const Viewer& viewer, ParticleArray& position);

/// The camera from which a change of poses is seen best: square to the way that most of it goes, with all blocks that stay near
/// in the picture.
Camera bestSide(const Camera& camera, const ParticleArray& before, const ParticleArray& after);

}  // namespace springtower
