#pragma once

#include "apps/viewer/input/camera.h"
#include "apps/viewer/input/places.h"

#include <span>

namespace springtower {

// How a block that is free is carried. All are functions of poses, camera and the mouse's way.

inline constexpr double kCarryHeight_m = 0.006;  ///< of a carried block over what lies below it
inline constexpr double kGuidedCarry_m_s = 0.4;  ///< speed of the hand while it lifts and carries

/// Speed at which the hand turns a carried block, rad/s: a quarter turn takes 0.7 s. Implicit steps turn a block by at most
/// tuning::kMaxTurnPerStep each; up to 2.4 rad/s the four of a frame suffice, and beyond it a frame may take kMaxLedSteps.
inline constexpr double kGuidedTurn_rad_s = 2.2;

/// Where a carried block moves when the mouse moves by some pixels, m: what is seen at the mouse is where it goes. Over the tower
/// it moves in the level plane in which it will lie; beside it in the upright plane that faces the camera, or on the floor, and
/// kCarryHeight_m above what lies below it. `over`: where it was to be carried so far.
Vec3 carriedBy(const Camera& camera, const Viewport& viewport, std::span<const Footprint> all, std::size_t held,
               const Vec3& dimensions, const Place& over, const Eigen::Vector2d& moved_px);

/// The place of the hand at the end of the coming frame, on its way from `hand` to a goal, and its orientation on the way to that
/// of the goal. The way is level at a height clear of all that lies under the rest of it: the hand rises first, then moves, and
/// sinks to the goal's height last. It turns where there is room. `block_m`: the height of the block itself, which may be behind.
Place carryStep(std::span<const Footprint> all, std::size_t held, const Vec3& dimensions, const Place& hand, double block_m,
                const Place& goal, double frame_s);

/// Whether the hand is at the goal, to within the rounding of its steps.
bool isAt(const Place& hand, const Place& goal);

}  // namespace springtower
