#include "apps/viewer/input/view.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace springtower {
namespace {

constexpr double kFromHome_m = 0.12;  // most distance of what the camera looks at from the held block
constexpr double kSameAngle_rad = 1e-3;
constexpr double kSameWay_m = 5e-4;

double turnBetween(double from, double to) {
  return std::remainder(to - from, 2.0 * std::numbers::pi);
}

}  // namespace

double squareTo(const Camera& camera, const Vec3& line) {
  // The picture's right is (-sin, cos) of the azimuth.
  const double first = std::atan2(-line.x(), line.y());
  const double second = std::remainder(first + std::numbers::pi, 2.0 * std::numbers::pi);
  const bool nearer = std::abs(turnBetween(camera.azimuth, first)) <= std::abs(turnBetween(camera.azimuth, second));
  return nearer ? first : second;
}

Camera viewOfHeld(const Camera& home, double azimuth, const Vec3& block, bool carried) {
  Camera view = home;
  const Vec3 back = home.target - block;
  const double length = back.norm();
  view.target = block + (length > kFromHome_m ? Vec3(back * (kFromHome_m / length)) : back);
  view.azimuth = azimuth;
  view.elevation = carried ? std::max(home.elevation, kHighestHeld) : std::clamp(home.elevation, kLowestHeld, kHighestHeld);
  view.distance = std::min(home.distance, kHeldDistance_m);
  return view;
}

void ease(Camera& camera, const Camera& goal, double elapsed_s) {
  const double share = 1.0 - std::pow(0.05, elapsed_s / kEase_s);
  camera.target += share * (goal.target - camera.target);
  camera.azimuth = std::remainder(camera.azimuth + share * turnBetween(camera.azimuth, goal.azimuth), 2.0 * std::numbers::pi);
  camera.elevation += share * (goal.elevation - camera.elevation);
  camera.distance += share * (goal.distance - camera.distance);
}

bool showsTheSame(const Camera& a, const Camera& b) {
  return (a.target - b.target).norm() < kSameWay_m && std::abs(a.distance - b.distance) < kSameWay_m &&
         std::abs(turnBetween(a.azimuth, b.azimuth)) < kSameAngle_rad && std::abs(a.elevation - b.elevation) < kSameAngle_rad;
}

}  // namespace springtower
