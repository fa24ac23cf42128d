#pragma once

#include "apps/viewer/input/camera.h"
#include "apps/viewer/session/footprint.h"

#include <optional>

namespace springtower {

// How a drag becomes a pull along one of the block's own axes. All are functions of poses, camera and the mouse's way.

/// The way on which a drag pulls a block out: of the four ways along the two horizontal axes of the block, the one that is
/// nearest on the screen to the mouse's way (pixels, y downwards). A way with a neighbour right in it does not count, and ways
/// along the block's length count before those across it by kLengthAdvantage. A unit vector along the block's edge, so level as
/// the block is; empty where all of these ways lie more than 90 degrees off the mouse's.
std::optional<Vec3> pullWay(const ParticleArray& position, std::size_t block, const Camera& camera, const Viewport& viewport,
                            const Eigen::Vector2d& mouseWay_px);

inline constexpr double kLengthAdvantage = 0.35;  ///< rad, 20 degrees: most drags are meant along the block

/// Whether another block lies right in the way (unit, horizontal) of a block: within 2.5 mm, beside it.
bool isBlocked(const ParticleArray& position, std::size_t block, const Vec3& way);

/// Whether nothing lies over a block or so near beside it and higher that it could not be lifted straight up.
bool isClearAbove(const ParticleArray& position, std::size_t block);

/// How far the mouse moves a block along its way, m, when it moves by some pixels: as far as a point at the block moves on the
/// screen. What counts is the mouse's motion between the way as it is seen and the way the drag began with (pixels, any length),
/// so that neither a camera that turns nor a drag that began askew loses the block. `point`: m, the block's centre.
double pulledBy(const Camera& camera, const Viewport& viewport, const Vec3& point, const Vec3& way,
                const Eigen::Vector2d& firstWay_px, const Eigen::Vector2d& moved_px);

/// The part of the mouse's motion that does not count in that, pixels.
Eigen::Vector2d leftOver(const Camera& camera, const Viewport& viewport, const Vec3& point, const Vec3& way,
                         const Eigen::Vector2d& firstWay_px, const Eigen::Vector2d& moved_px);

/// The speed of the hand along its line in the coming frame, m/s, signed, towards what is left of its way (m, signed): it gains
/// and loses speed evenly and comes to rest at the end. `speed_m_s`: the present one.
double pullSpeed(double left_m, double speed_m_s, double frame_s);

inline constexpr double kGuidedPull_m_s = 0.08;  ///< the largest

/// How far the hand sinks in a frame while it pulls, m, beside following the block's height: it comes to press on the block with
/// kPullPress of its weight. A hand that only follows carries the block some micrometres too high where that leaves one of its
/// supports, and what lies loosely on it is dragged along by up to a millimetre. `gravity_m_s2`: downwards; `rate_rad_s`: of the
/// hand's spring.
double pressDepth(double gravity_m_s2, double rate_rad_s, double frame_s);

inline constexpr double kPullPress = 0.2;  ///< block weights

}  // namespace springtower
