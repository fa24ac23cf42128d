#include "apps/viewer/input/guided_pull.h"

#include "core/tuning.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace springtower {
namespace {

constexpr double kInTheWay_m = 0.0025;    // how far ahead of a block a neighbour blocks it
constexpr double kSideBySide_m = 0.001;   // overlap of neighbours that lie askew beside each other
constexpr double kSameHeight = 0.25;      // of a block's height: what is off by less lies in its row
constexpr double kLeastSeen = 0.2;        // of its length: a way that is foreshortened more has no direction on the screen
constexpr double kClearBeside_m = 0.004;  // room beside a block that is lifted

// The axis of a block that points up.
std::size_t upAxis(const Eigen::Matrix3d& edges) {
  Eigen::Index best = 0;
  edges.colwise().normalized().row(2).cwiseAbs().maxCoeff(&best);
  return static_cast<std::size_t>(best);
}

// Where a way leads on the screen, in pixels a metre.
Eigen::Vector2d seenWay(const Camera& camera, const Viewport& viewport, const Vec3& point, const Vec3& way) {
  constexpr double kShort_m = 1e-3;
  const auto from = seenAt(camera, viewport, point);
  const auto to = seenAt(camera, viewport, point + kShort_m * way);
  return from && to ? Eigen::Vector2d((*to - *from) / kShort_m) : Eigen::Vector2d::Zero();
}

double angleOf(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return std::atan2(std::abs(a.x() * b.y() - a.y() * b.x()), a.dot(b));
}

// The direction on the screen that moves the block forward.
Eigen::Vector2d forward(const Camera& camera, const Viewport& viewport, const Vec3& point, const Vec3& way,
                        const Eigen::Vector2d& firstWay_px) {
  const Eigen::Vector2d seen = seenWay(camera, viewport, point, way) * metresPerPixel(camera, viewport, point);
  if (seen.norm() < kLeastSeen) return firstWay_px.normalized();
  const Eigen::Vector2d first = firstWay_px.normalized();
  const Eigen::Vector2d between = seen.normalized() + first;
  return between.norm() < kLeastSeen ? Eigen::Vector2d(seen.normalized()) : Eigen::Vector2d(between.normalized());
}

}  // namespace

std::optional<Vec3> pullWay(const ParticleArray& position, std::size_t block, const Camera& camera, const Viewport& viewport,
                            const Eigen::Vector2d& mouseWay_px) {
  const Eigen::Matrix3d edges = meanEdges(position, block);
  const std::size_t up = upAxis(edges);
  const Vec3 middle = centre(position, block);
  double longest = 0.0;
  for (std::size_t a = 0; a < 3; ++a) {
    if (a != up) longest = std::max(longest, edges.col(static_cast<Eigen::Index>(a)).norm());
  }
  std::optional<Vec3> best;
  double least = std::numbers::pi;
  for (std::size_t a = 0; a < 3; ++a) {
    if (a == up) continue;
    const Vec3 edge = edges.col(static_cast<Eigen::Index>(a));
    for (const double sign : {-1.0, 1.0}) {
      const Vec3 way = sign * edge.normalized();
      const double angle = angleOf(seenWay(camera, viewport, middle, way), mouseWay_px);
      const double counted = angle + (edge.norm() < longest ? kLengthAdvantage : 0.0);
      if (angle >= 0.5 * std::numbers::pi || counted >= least || isBlocked(position, block, way)) continue;
      least = counted;
      best = way;
    }
  }
  return best;
}

bool isBlocked(const ParticleArray& position, std::size_t block, const Vec3& way) {
  const Footprint own = footprintOf(position, block);
  Footprint ahead = own;
  ahead.middle += kInTheWay_m * way.head<2>();
  const double overlap = kSameHeight * (own.top_m - own.bottom_m);
  for (std::size_t b = 0; b < position.blockCount(); ++b) {
    if (b == block) continue;
    const Footprint other = footprintOf(position, b);
    const bool beside = std::min(own.top_m, other.top_m) - std::max(own.bottom_m, other.bottom_m) > overlap;
    if (beside && overlapOf(ahead, other) > kSideBySide_m) return true;
  }
  return false;
}

bool isClearAbove(const ParticleArray& position, std::size_t block) {
  const Footprint own = footprintOf(position, block);
  const Footprint around = grown(own, kClearBeside_m);
  const double middle = 0.5 * (own.top_m + own.bottom_m) + kSameHeight * (own.top_m - own.bottom_m);
  for (std::size_t b = 0; b < position.blockCount(); ++b) {
    if (b == block) continue;
    const Footprint other = footprintOf(position, b);
    if (0.5 * (other.top_m + other.bottom_m) > middle && overlapOf(around, other) > 0.0) return false;
  }
  return true;
}

double pulledBy(const Camera& camera, const Viewport& viewport, const Vec3& point, const Vec3& way,
                const Eigen::Vector2d& firstWay_px, const Eigen::Vector2d& moved_px) {
  return metresPerPixel(camera, viewport, point) * moved_px.dot(forward(camera, viewport, point, way, firstWay_px));
}

Eigen::Vector2d leftOver(const Camera& camera, const Viewport& viewport, const Vec3& point, const Vec3& way,
                         const Eigen::Vector2d& firstWay_px, const Eigen::Vector2d& moved_px) {
  const Eigen::Vector2d along = forward(camera, viewport, point, way, firstWay_px);
  return moved_px - moved_px.dot(along) * along;
}

double pullSpeed(double left_m, double speed_m_s, double frame_s) {
  const double kGain_m_s2 = kGuidedPull_m_s * kGuidedPull_m_s / (2.0 * tuning::kDrawRampLength_m);
  // The speed from which it comes to rest in what is left, after a frame at it.
  const double frameGain = kGain_m_s2 * frame_s;
  const double stopping = std::sqrt(frameGain * frameGain + 2.0 * kGain_m_s2 * std::abs(left_m)) - frameGain;
  const double most = std::min({kGuidedPull_m_s, stopping, std::abs(left_m) / frame_s});
  const double wanted = std::copysign(most, left_m);
  return std::clamp(wanted, speed_m_s - kGain_m_s2 * frame_s, speed_m_s + kGain_m_s2 * frame_s);
}

double pressDepth(double gravity_m_s2, double rate_rad_s, double frame_s) {
  const double pressed_m = kPullPress * std::max(gravity_m_s2, 0.0) / (rate_rad_s * rate_rad_s);
  return pressed_m * (1.0 - std::exp(-frame_s / tuning::kHeightFollowTime_s));
}

}  // namespace springtower
