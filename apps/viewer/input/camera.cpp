#include "apps/viewer/input/camera.h"

#include "core/block.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace springtower {
namespace {

constexpr double kLowest = -5.0 * std::numbers::pi / 180.0;
constexpr double kHighest = 89.0 * std::numbers::pi / 180.0;
constexpr double kZoomStep = 0.9;
constexpr double kNearest_m = 0.05;
constexpr double kFarthest_m = 20.0;
constexpr double kNearPlane_m = 0.02;
constexpr double kFarPlane_m = 60.0;

// Distance along the ray at which it meets a triangle; infinite when it does not.
double meets(const Ray& ray, const Vec3& a, const Vec3& b, const Vec3& c) {
  constexpr double kNever = std::numeric_limits<double>::infinity();
  const Vec3 ab = b - a;
  const Vec3 ac = c - a;
  const Vec3 p = ray.direction.cross(ac);
  const double determinant = ab.dot(p);
  if (determinant == 0.0) return kNever;
  const Vec3 fromA = ray.origin - a;
  const double u = fromA.dot(p) / determinant;
  const Vec3 q = fromA.cross(ab);
  const double v = ray.direction.dot(q) / determinant;
  if (!(u >= 0.0 && v >= 0.0 && u + v <= 1.0)) return kNever;
  const double distance = ac.dot(q) / determinant;
  return distance > 0.0 ? distance : kNever;
}

double pixelsAtUnitDistance(const Camera& camera, const Viewport& viewport) {
  return 0.5 * viewport.height / std::tan(0.5 * camera.fieldOfView);
}

}  // namespace

CameraFrame cameraFrame(const Camera& camera) {
  CameraFrame frame;
  frame.back = {std::cos(camera.elevation) * std::cos(camera.azimuth), std::cos(camera.elevation) * std::sin(camera.azimuth),
                std::sin(camera.elevation)};
  frame.right = {-std::sin(camera.azimuth), std::cos(camera.azimuth), 0.0};
  frame.up = frame.back.cross(frame.right);
  frame.eye = camera.target + camera.distance * frame.back;
  return frame;
}

void orbit(Camera& camera, double azimuth, double elevation) {
  camera.azimuth = std::remainder(camera.azimuth + azimuth, 2.0 * std::numbers::pi);
  camera.elevation = std::clamp(camera.elevation + elevation, kLowest, kHighest);
}

void zoom(Camera& camera, double steps) {
  camera.distance = std::clamp(camera.distance * std::pow(kZoomStep, steps), kNearest_m, kFarthest_m);
}

void showAll(Camera& camera, const ParticleArray& position) {
  Vec3 low = position.at(0, 0);
  Vec3 high = low;
  for (std::size_t b = 0; b < position.blockCount(); ++b) {
    for (std::size_t c = 0; c < kCorners; ++c) {
      low = low.cwiseMin(position.at(b, c));
      high = high.cwiseMax(position.at(b, c));
    }
  }
  camera.target = 0.5 * (low + high);
  const double radius = 0.5 * (high - low).norm() + 0.02;
  camera.distance = std::clamp(1.05 * radius / std::sin(0.5 * camera.fieldOfView), kNearest_m, kFarthest_m);
}

Ray rayThrough(const Camera& camera, const Viewport& viewport, double x, double y) {
  const CameraFrame frame = cameraFrame(camera);
  const double pixels = pixelsAtUnitDistance(camera, viewport);
  const Vec3 direction = (x - 0.5 * viewport.width) * frame.right - (y - 0.5 * viewport.height) * frame.up - pixels * frame.back;
  return {frame.eye, direction.normalized()};
}

std::optional<Eigen::Vector2d> seenAt(const Camera& camera, const Viewport& viewport, const Vec3& point) {
  const CameraFrame frame = cameraFrame(camera);
  const Vec3 toPoint = point - frame.eye;
  const double depth = -toPoint.dot(frame.back);
  if (depth <= 0.0) return {};
  const double pixels = pixelsAtUnitDistance(camera, viewport) / depth;
  return Eigen::Vector2d(0.5 * viewport.width + pixels * toPoint.dot(frame.right),
                         0.5 * viewport.height - pixels * toPoint.dot(frame.up));
}

double metresPerPixel(const Camera& camera, const Viewport& viewport, const Vec3& point) {
  const CameraFrame frame = cameraFrame(camera);
  return std::max((frame.eye - point).dot(frame.back), kNearPlane_m) / pixelsAtUnitDistance(camera, viewport);
}

Eigen::Matrix4f clipFromWorld(const Camera& camera, const Viewport& viewport) {
  const CameraFrame frame = cameraFrame(camera);
  Eigen::Matrix4d view = Eigen::Matrix4d::Identity();
  view.block<1, 3>(0, 0) = frame.right.transpose();
  view.block<1, 3>(1, 0) = frame.up.transpose();
  view.block<1, 3>(2, 0) = frame.back.transpose();
  view.block<3, 1>(0, 3) = -view.block<3, 3>(0, 0) * frame.eye;
  const double focal = 1.0 / std::tan(0.5 * camera.fieldOfView);
  Eigen::Matrix4d projection = Eigen::Matrix4d::Zero();
  projection(0, 0) = focal * viewport.height / viewport.width;
  projection(1, 1) = focal;
  projection(2, 2) = -(kFarPlane_m + kNearPlane_m) / (kFarPlane_m - kNearPlane_m);
  projection(2, 3) = -2.0 * kFarPlane_m * kNearPlane_m / (kFarPlane_m - kNearPlane_m);
  projection(3, 2) = -1.0;
  return (projection * view).cast<float>();
}

std::optional<Pick> pickBlock(const ParticleArray& position, const Ray& ray) {
  std::optional<Pick> nearest;
  for (std::size_t b = 0; b < position.blockCount(); ++b) {
    for (std::size_t t = 0; t < kTriangles; ++t) {
      const auto corner = [&](std::size_t i) { return position.at(b, static_cast<std::size_t>(kTriangleCorners[t][i])); };
      const double distance = meets(ray, corner(0), corner(1), corner(2));
      if (!std::isfinite(distance) || (nearest && nearest->distance <= distance)) continue;
      nearest = Pick{blockId(b), t / 2, distance, ray.origin + distance * ray.direction};
    }
  }
  return nearest;
}

}  // namespace springtower
