#include "apps/viewer/input/guided_carry.h"

#include "core/rotation_vector.h"
#include "core/tuning.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace springtower {
namespace {

constexpr double kBesideTop_m = 0.01;  // how far beside the top the mouse still is over it

constexpr double kAboveTop_m = 0.1;         // most height over the top to which a block is lifted
constexpr double kLookEvery_m = 0.01;       // along the way
constexpr double kFarthestCarried_m = 2.0;  // from the axis of the tower
constexpr double kBelow_m = 0.002;          // height that may be missing where the block moves on
constexpr double kArrived_m = 1e-6;
constexpr double kTurned_rad = 1e-3;

double heightOfBlock(const Footprint& footprint) {
  return footprint.top_m - footprint.bottom_m;
}

// Where a ray meets a plane; empty when it does not.
std::optional<Vec3> meetsPlane(const Ray& ray, const Vec3& point, const Vec3& normal) {
  const double towards = ray.direction.dot(normal);
  if (towards == 0.0) return {};
  const double distance = (point - ray.origin).dot(normal) / towards;
  if (distance <= 0.0) return {};
  return Vec3(ray.origin + distance * ray.direction);
}

double highestTop(std::span<const Footprint> all, std::size_t held) {
  double top = 0.0;
  for (std::size_t b = 0; b < all.size(); ++b) {
    if (b != held) top = std::max(top, all[b].top_m);
  }
  return top;
}

Footprint movedTo(Footprint footprint, const Vec3& place) {
  footprint.middle = place.head<2>();
  return footprint;
}

// Everything that the block may cover while it turns about its middle.
Footprint turning(Footprint footprint) {
  footprint.half = Eigen::Vector2d::Constant(footprint.half.norm());
  return footprint;
}

}  // namespace

Vec3 carriedBy(const Camera& camera, const Viewport& viewport, std::span<const Footprint> all, std::size_t held,
               const Vec3& dimensions, const Place& over, const Eigen::Vector2d& moved_px) {
  const auto seen = seenAt(camera, viewport, over.centre);
  if (!seen) return over.centre;
  const Ray ray = rayThrough(camera, viewport, seen->x() + moved_px.x(), seen->y() + moved_px.y());
  const Footprint own = footprintOf(over.centre, over.turn, dimensions);
  const double lift = 0.5 * heightOfBlock(own) + kCarryHeight_m;
  const double top = highestTop(all, held);
  const double height = heightOfBlock(own);
  if (const auto level = meetsPlane(ray, Vec3(0.0, 0.0, top + 0.5 * height), Vec3::UnitZ())) {
    if (levelBelow(all, held, grown(movedTo(own, *level), kBesideTop_m - tuning::kMinOutlineOverlap_m)) > top - 2.0 * height)
      return *level;
  }
  const CameraFrame frame = cameraFrame(camera);
  auto place = meetsPlane(ray, over.centre, Vec3(frame.back.x(), frame.back.y(), 0.0));
  if (!place || place->z() < lift) place = meetsPlane(ray, Vec3(0.0, 0.0, lift), Vec3::UnitZ());
  if (!place || place->head<2>().norm() > kFarthestCarried_m) return over.centre;
  const double least = lift + levelBelow(all, held, grown(movedTo(own, *place), kRoomBeside_m));
  place->z() = std::clamp(place->z(), least, std::max(least, top + kAboveTop_m));
  return *place;
}

Place carryStep(std::span<const Footprint> all, std::size_t held, const Vec3& dimensions, const Place& hand, double block_m,
                const Place& goal, double frame_s) {
  Footprint own = grown(footprintOf(hand.centre, hand.turn, dimensions), kRoomBeside_m);
  const double lift = 0.5 * heightOfBlock(own) + kCarryHeight_m;
  const double left = angleBetween(hand.turn, goal.turn);
  if (left > kTurned_rad) own = turning(own);
  const Vec3 way(goal.centre.x() - hand.centre.x(), goal.centre.y() - hand.centre.y(), 0.0);
  const double distance = way.norm();
  const int looks = 1 + static_cast<int>(distance / kLookEvery_m);
  double level = 0.0;
  for (int i = 0; i <= looks; ++i) {
    level = std::max(level, levelBelow(all, held, movedTo(own, hand.centre + way * (static_cast<double>(i) / looks))));
  }
  const double clear = level > 0.0 ? level + lift : goal.centre.z();
  const bool onItsWay = distance > kArrived_m || left > kTurned_rad;
  const double height = onItsWay ? std::max(clear, goal.centre.z()) : goal.centre.z();
  const double step = kGuidedCarry_m_s * frame_s;
  Place next = hand;
  next.centre.z() += std::clamp(height - hand.centre.z(), -step, step);
  if (onItsWay && std::min(hand.centre.z(), block_m) < clear - kBelow_m) return next;
  const double share = distance > step ? step / distance : 1.0;
  next.centre.head<2>() += share * way.head<2>();
  const double turn = kGuidedTurn_rad_s * frame_s;
  next.turn = left > turn ? orientationBetween(hand.turn, goal.turn, turn / left) : goal.turn;
  return next;
}

bool isAt(const Place& hand, const Place& goal) {
  return (hand.centre - goal.centre).norm() < kArrived_m && angleBetween(hand.turn, goal.turn) < kTurned_rad;
}

}  // namespace springtower
