#include "apps/viewer/input/places.h"

#include "core/rotation_vector.h"
#include "core/tuning.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace springtower {
namespace {

constexpr double kSameSize = 0.05;      // share by which blocks of one kind may differ
constexpr double kLying = 0.95;         // least vertical part of a lying block's own z axis
constexpr double kTaken_m = 0.003;      // overlap with another block from which a place is taken
constexpr double kReach_m = 0.065;      // how far off its place a block still goes there: what is far or near is hard to see
constexpr double kSameLevel_m = 0.001;  // of supports
constexpr double kLeastInside = 0.1;    // of a side, that a middle is inside its supports
constexpr std::size_t kRow = 3;         // blocks

bool sameKind(const Vec3& a, const Vec3& b) {
  return ((a - b).cwiseAbs().array() <= kSameSize * b.array()).all();
}

// Blocks of one kind that lie at one height.
std::vector<std::size_t> rowAt(const ParticleArray& position, std::span<const Vec3> dimensions, std::size_t held, double z) {
  std::vector<std::size_t> row;
  for (std::size_t b = 0; b < position.blockCount(); ++b) {
    if (b == held || !sameKind(dimensions[b], dimensions[held])) continue;
    if (std::abs(centre(position, b).z() - z) > 0.5 * dimensions[held].z()) continue;
    if (std::abs(meanEdge(position, b, 2).normalized().z()) > kLying) row.push_back(b);
  }
  return row;
}

// A row of three as the ground of another: its middle, the directions of its blocks and across, and up.
struct RowFrame {
  Vec3 middle = Vec3::Zero();
  Vec3 along = Vec3::Zero();
  Vec3 up = Vec3::Zero();
};

RowFrame frameOf(const ParticleArray& position, std::span<const std::size_t> row) {
  RowFrame frame;
  for (const std::size_t b : row) {
    const Vec3 edge = meanEdge(position, b, 0).normalized();
    const Vec3 up = meanEdge(position, b, 2).normalized();
    frame.middle += centre(position, b) / static_cast<double>(row.size());
    frame.along += frame.along.dot(edge) < 0.0 ? Vec3(-edge) : edge;
    frame.up += up.z() < 0.0 ? Vec3(-up) : up;
  }
  frame.along.z() = 0.0;
  frame.along.normalize();
  frame.up.normalize();
  return frame;
}

// Moves a place along the row away from the blocks that lie in it already.
void makeWay(const ParticleArray& position, std::span<const std::size_t> row, const Vec3& along, double half, Vec3& place) {
  double least = -1e300;
  double most = 1e300;
  for (const std::size_t b : row) {
    const bool before = centre(position, b).dot(along) < place.dot(along);
    for (std::size_t c = 0; c < kCorners; ++c) {
      const double at = position.at(b, c).dot(along);
      if (before) least = std::max(least, at + half + tuning::kPlaceGap_m);
      if (!before) most = std::min(most, at - half - tuning::kPlaceGap_m);
    }
  }
  const double now = place.dot(along);
  place += ((least > most ? 0.5 * (least + most) : std::clamp(now, least, most)) - now) * along;
}

double turnedBy(const Eigen::Quaterniond& a, const Eigen::Quaterniond& b) {
  return angleBetween(a, b);
}

// The level orientation whose length lies in a direction and that is nearer to the present one.
Eigen::Quaterniond turnAlong(const Vec3& direction, const Vec3& up, const Eigen::Quaterniond& turn) {
  const Eigen::Quaterniond first = rotationAbout(Vec3::UnitZ(), std::atan2(direction.y(), direction.x()));
  const Eigen::Quaterniond second = rotationAbout(Vec3::UnitZ(), std::numbers::pi) * first;
  const Eigen::Quaterniond lean = Eigen::Quaterniond::FromTwoVectors(Vec3::UnitZ(), up);
  return lean * (turnedBy(first, turn) <= turnedBy(second, turn) ? first : second);
}

// Whether what lies under a footprint at a level reaches round its middle, on a grid of points.
bool isSupported(std::span<const Footprint> all, std::size_t held, const Footprint& footprint, double level_m) {
  if (level_m <= 0.0) return true;
  constexpr int kPoints = 10;  // to each side
  Eigen::Vector2d least = Eigen::Vector2d::Constant(2.0);
  Eigen::Vector2d most = -least;
  for (int i = -kPoints; i <= kPoints; ++i) {
    for (int j = -kPoints; j <= kPoints; ++j) {
      const Eigen::Vector2d share = Eigen::Vector2d(i, j) / kPoints;
      const Eigen::Vector2d point = footprint.middle + share.x() * footprint.half.x() * footprint.axis[0] +
                                    share.y() * footprint.half.y() * footprint.axis[1];
      for (std::size_t b = 0; b < all.size(); ++b) {
        if (b == held || std::abs(all[b].top_m - level_m) > kSameLevel_m) continue;
        const Eigen::Vector2d from = point - all[b].middle;
        if (std::abs(from.dot(all[b].axis[0])) > all[b].half.x() || std::abs(from.dot(all[b].axis[1])) > all[b].half.y())
          continue;
        least = least.cwiseMin(share);
        most = most.cwiseMax(share);
        break;
      }
    }
  }
  return least.maxCoeff() < -2.0 * kLeastInside && most.minCoeff() > 2.0 * kLeastInside;
}

}  // namespace

std::vector<Place> topPlaces(const ParticleArray& position, std::span<const Vec3> dimensions, std::size_t held,
                             const Eigen::Quaterniond& turn) {
  const Vec3& size = dimensions[held];
  double highest = -1e300;
  for (std::size_t b = 0; b < position.blockCount(); ++b) {
    if (b != held && sameKind(dimensions[b], size)) highest = std::max(highest, centre(position, b).z());
  }
  const std::vector<std::size_t> top = rowAt(position, dimensions, held, highest);
  const bool isFull = top.size() >= kRow;
  const std::vector<std::size_t> base = isFull ? top : rowAt(position, dimensions, held, highest - size.z());
  if (base.size() != kRow) return {};
  const RowFrame frame = frameOf(position, base);
  const Vec3 across = Vec3::UnitZ().cross(frame.along);
  const std::vector<std::size_t> inRow = isFull ? std::vector<std::size_t>{} : top;
  std::vector<Place> places;
  for (const double number : {-1.0, 0.0, 1.0}) {
    Place place{frame.middle + 0.5 * number * (size.x() - size.y()) * frame.along + size.z() * frame.up,
                turnAlong(across, frame.up, turn)};
    const Footprint footprint = footprintOf(place.centre, place.turn, size);
    const bool taken = std::any_of(inRow.begin(), inRow.end(),
                                   [&](std::size_t b) { return overlapOf(footprint, footprintOf(position, b)) > kTaken_m; });
    if (taken) continue;
    makeWay(position, inRow, frame.along, 0.5 * size.y(), place.centre);
    places.push_back(place);
  }
  return places;
}

Landing landingAt(std::span<const Footprint> all, std::span<const Vec3> dimensions, std::size_t held, const Place& over,
                  std::span<const Place> rowPlaces, bool keepTurn) {
  const Vec3& size = dimensions[held];
  Landing landing{over, false, false};
  double nearest = 1e300;
  for (const Place& place : rowPlaces) {
    const Vec3 length = place.turn * Vec3::UnitX();
    const Vec3 off = over.centre - place.centre;
    const double along = std::abs(off.head<2>().dot(length.head<2>()));
    const double across = std::abs(off.x() * length.y() - off.y() * length.x());
    const bool turned = std::abs((over.turn * Vec3::UnitX()).dot(length)) < std::numbers::sqrt2 / 2.0;
    if (along > kReach_m || across > kReach_m || across >= nearest || (keepTurn && turned)) continue;
    nearest = across;
    landing.place = place;
    landing.inRow = true;
  }
  const Footprint footprint = footprintOf(landing.place.centre, landing.place.turn, size);
  const double level = levelBelow(all, held, landing.inRow ? footprint : grown(footprint, kRoomBeside_m));
  landing.place.centre.z() = level + 0.5 * (footprint.top_m - footprint.bottom_m);
  landing.fits = isSupported(all, held, footprint, level);
  return landing;
}

}  // namespace springtower
