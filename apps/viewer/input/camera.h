#pragma once

#include "core/ids.h"
#include "core/state.h"

#include <Eigen/Core>
#include <optional>

namespace springtower {

/// A camera that always looks at one point and goes round it on a sphere (report 6.2.1). Angles in radians.
struct Camera {
  Vec3 target{0.0, 0.0, 0.16};  ///< m, the point looked at
  double azimuth = -0.9076;     ///< where the eye stands, from +x over +y; default -52 degrees: bit codes read left to right
  double elevation = 0.3142;    ///< above the horizon
  double distance = 0.85;       ///< m, of the eye from the target
  double fieldOfView = 0.61;    ///< from the lower to the upper side of the picture
};

/// The picture's size in pixels.
struct Viewport {
  int width = 1280;
  int height = 800;
};

/// The camera's place and axes: unit vectors to the right, up, and back towards the viewer.
struct CameraFrame {
  Vec3 eye;
  Vec3 right;
  Vec3 up;
  Vec3 back;
};
CameraFrame cameraFrame(const Camera& camera);

/// Goes round the target. The elevation stays between -5 and 89 degrees, so that up stays up and the eye over the floor.
void orbit(Camera& camera, double azimuth, double elevation);

/// Comes nearer (positive steps, as of a mouse wheel) or goes away, a ninth a step, between 0.05 and 20 m.
void zoom(Camera& camera, double steps);

/// Looks at the middle of all blocks from a distance that shows them all. Precondition: at least one block.
void showAll(Camera& camera, const ParticleArray& position);

/// A half line: origin in metres, unit direction.
struct Ray {
  Vec3 origin;
  Vec3 direction;
};

/// The ray of sight through a point of the picture; (0, 0) is its upper left corner, in pixels.
Ray rayThrough(const Camera& camera, const Viewport& viewport, double x, double y);

/// Where a point is seen, in pixels; empty when it is behind the eye.
std::optional<Eigen::Vector2d> seenAt(const Camera& camera, const Viewport& viewport, const Vec3& point);

/// Metres that a pixel spans in the plane through `point` that is parallel to the screen.
double metresPerPixel(const Camera& camera, const Viewport& viewport, const Vec3& point);

/// World to clip space as OpenGL defines it, column major; the depth range fits scenes from 0.02 m to 60 m.
Eigen::Matrix4f clipFromWorld(const Camera& camera, const Viewport& viewport);

/// What a ray meets first.
struct Pick {
  BlockId block = kFloor;
  std::size_t face = 0;   ///< 0..5, see kFaceCorners
  double distance = 0.0;  ///< m along the ray
  Vec3 point = Vec3::Zero();
};

/// The nearest face of any block that a ray meets (report 4.8.1), by its two triangles as they are drawn (Moeller & Trumbore
/// 1997). Both sides of a face count. Empty when there is none.
std::optional<Pick> pickBlock(const ParticleArray& position, const Ray& ray);

}  // namespace springtower
