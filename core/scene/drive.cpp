#include "core/scene/drive.h"

#include "core/elementary.h"
#include "core/rotation_vector.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace springtower {

double Drive::mostSpeed_m_s(double radius_m) const {
  return velocity.norm() + radius_m * spin.norm() + 2.0 * std::numbers::pi * frequency_hz * amplitude.norm();
}

DrivenPose drivenPose(std::span<const Drive> drives, int block, const Vec3& centre, double radius_m, double time_s) {
  DrivenPose pose;
  pose.centre = centre;
  for (const Drive& drive : drives) {
    if (drive.block != block) continue;
    const double passed_s = std::clamp(time_s, drive.start_s, drive.end_s) - drive.start_s;
    const bool acts = drive.start_s <= time_s && time_s < drive.end_s;
    const double rate = 2.0 * std::numbers::pi * drive.frequency_hz;
    const Eigen::Quaterniond turn = rotation(passed_s * drive.spin);
    pose.centre += passed_s * drive.velocity + (1.0 - elementary::cos(rate * passed_s)) * drive.amplitude;
    pose.turn = turn * pose.turn;
    pose.spin = turn * pose.spin;
    if (acts) {
      pose.velocity += drive.velocity + rate * elementary::sin(rate * passed_s) * drive.amplitude;
      pose.spin += drive.spin;
    }
    pose.travel_m += passed_s * drive.mostSpeed_m_s(radius_m);
  }
  return pose;
}

}  // namespace springtower
