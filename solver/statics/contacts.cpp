#include "solver/statics/contacts.h"

#include "core/tuning.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>

namespace springtower {
namespace {

struct Box {
  Vec3 centre;
  Eigen::Matrix3d axes;  // columns
  Vec3 half;

  [[nodiscard]] double reachAlong(const Vec3& direction) const { return (axes.transpose() * direction).cwiseAbs().dot(half); }
  [[nodiscard]] Vec3 corner(unsigned bits) const {
    Vec3 side;
    for (unsigned a = 0; a < 3; ++a) side[a] = ((bits >> a) & 1U) != 0U ? half[a] : -half[a];
    return centre + axes * side;
  }
};

Box boxOf(const BlockSpec& block) {
  return {block.centre, block.orientation.toRotationMatrix(), 0.5 * block.dimensions};
}

// An axis that may separate two boxes: its direction is unit, from b to a.
struct Axis {
  Vec3 direction = Vec3::Zero();
  double gap = -std::numeric_limits<double>::infinity();
  int ofA = -1;  // the box's own axis it comes from, or -1
  int ofB = -1;
};

Axis axisAlong(const Vec3& unit, const Box& a, const Box& b, int ofA, int ofB) {
  const double distance = (a.centre - b.centre).dot(unit);
  return {distance < 0.0 ? Vec3(-unit) : unit, std::abs(distance) - a.reachAlong(unit) - b.reachAlong(unit), ofA, ofB};
}

Axis bestAxis(const Box& a, const Box& b, double slack) {
  Axis best;
  for (int i = 0; i < 3; ++i) {
    for (const Axis& axis : {axisAlong(b.axes.col(i), a, b, -1, i), axisAlong(a.axes.col(i), a, b, i, -1)}) {
      // With a slack, so that of two faces that are flat on each other always the same is taken.
      if (axis.gap > best.gap + slack) best = axis;
    }
  }
  Axis edge;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      const Vec3 product = a.axes.col(i).cross(b.axes.col(j));
      const double sine = product.norm();
      if (sine < tuning::kStaticParallelSine) continue;
      const Axis axis = axisAlong(product / sine, a, b, i, j);
      if (axis.gap > edge.gap) edge = axis;
    }
  }
  return edge.gap > best.gap + slack ? edge : best;
}

// The box's face that looks most along a direction: the axis it lies across and its centre.
struct Face {
  int across;
  Vec3 centre;
  Vec3 normal;
};

Face faceAlong(const Box& box, const Vec3& direction) {
  int across = 0;
  const Vec3 cosines = box.axes.transpose() * direction;
  for (int a = 1; a < 3; ++a) {
    if (std::abs(cosines[a]) > std::abs(cosines[across])) across = a;
  }
  const Vec3 normal = cosines[across] < 0.0 ? Vec3(-box.axes.col(across)) : Vec3(box.axes.col(across));
  return {across, box.centre + normal * box.half[across], normal};
}

// Keeps what of a polygon lies below `limit` along a direction (Sutherland & Hodgman 1974). Give the limit a little slack: an
// edge that lies on it but for rounding would else be cut somewhere along its length.
std::vector<Vec3> clipped(const std::vector<Vec3>& polygon, const Vec3& direction, double limit) {
  std::vector<Vec3> kept;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vec3& from = polygon[i];
    const Vec3& to = polygon[(i + 1) % polygon.size()];
    const double before = from.dot(direction) - limit;
    const double after = to.dot(direction) - limit;
    if (before <= 0.0) kept.push_back(from);
    if ((before < 0.0 && after > 0.0) || (before > 0.0 && after < 0.0)) {
      kept.push_back(from + (to - from) * (before / (before - after)));
    }
  }
  return kept;
}

double areaOf(const std::vector<Vec3>& polygon) {
  Vec3 twice = Vec3::Zero();
  for (std::size_t i = 2; i < polygon.size(); ++i) twice += (polygon[i - 1] - polygon[0]).cross(polygon[i] - polygon[0]);
  return 0.5 * twice.norm();
}

// The part of `incident`'s face over `reference`'s face; `normal` is unit, out of the reference face.
std::vector<Vec3> overlapOfFaces(const Box& reference, const Box& incident, const Vec3& normal, double size) {
  const Face face = faceAlong(reference, normal);
  const Face other = faceAlong(incident, -normal);
  const int u = (other.across + 1) % 3;
  const int v = (other.across + 2) % 3;
  const Vec3 sideU = incident.axes.col(u) * incident.half[u];
  const Vec3 sideV = incident.axes.col(v) * incident.half[v];
  std::vector<Vec3> polygon = {other.centre - sideU - sideV, other.centre + sideU - sideV, other.centre + sideU + sideV,
                               other.centre - sideU + sideV};
  for (int a = 0; a < 3; ++a) {
    if (a == face.across) continue;
    const Vec3 side = reference.axes.col(a);
    const double middle = reference.centre.dot(side);
    const double half = reference.half[a] + tuning::kStaticClipSlack * size;
    polygon = clipped(polygon, side, half + middle);
    polygon = clipped(polygon, -side, half - middle);
  }
  const bool flat = face.normal.cross(other.normal).norm() < tuning::kStaticParallelSine;
  if (flat && areaOf(polygon) < tuning::kStaticTouchGap * size * size) polygon.clear();
  return polygon;
}

// Where two crossed edges come nearest: on a's edge.
Vec3 crossingOnA(const Box& a, const Box& b, const Axis& axis) {
  const auto edgeCentre = [](const Box& box, const Vec3& towards, int along) {
    Vec3 place = box.centre;
    for (int i = 0; i < 3; ++i) {
      if (i != along) place += box.axes.col(i) * (box.axes.col(i).dot(towards) < 0.0 ? -box.half[i] : box.half[i]);
    }
    return place;
  };
  const Vec3 onA = edgeCentre(a, -axis.direction, axis.ofA);
  const Vec3 onB = edgeCentre(b, axis.direction, axis.ofB);
  const Vec3 alongA = a.axes.col(axis.ofA);
  const Vec3 alongB = b.axes.col(axis.ofB);
  const double cosine = alongA.dot(alongB);
  const Vec3 between = onB - onA;
  return onA + alongA * ((between.dot(alongA) - cosine * between.dot(alongB)) / (1.0 - cosine * cosine));
}

void addPoint(FacePair& facing, const Vec3& place, double gap, double size, double reach) {
  const double touch = tuning::kStaticTouchGap * size;
  if (gap > touch && (gap > reach || std::abs(facing.normal.z()) < tuning::kStaticOverCosine)) return;
  const bool known = std::any_of(facing.points.begin(), facing.points.end(),
                                 [&](const FacingPoint& point) { return (point.place - place).norm() <= touch; });
  if (!known) facing.points.push_back({place, gap > touch ? gap : 0.0});
}

std::optional<FacePair> facingOf(const std::vector<Box>& boxes, std::size_t first, std::size_t second, double reach) {
  const double size = 2.0 * std::min(boxes[first].half.minCoeff(), boxes[second].half.minCoeff());
  Axis axis = bestAxis(boxes[first], boxes[second], tuning::kStaticFaceSlack * size);
  if (axis.gap > std::max(reach, tuning::kStaticTouchGap * size)) return {};
  // The block that lies higher along the axis is the upper one.
  if (axis.direction.z() < -tuning::kStaticParallelSine) {
    std::swap(first, second);
    axis = {-axis.direction, axis.gap, axis.ofB, axis.ofA};
  }
  const Box& upper = boxes[first];
  const Box& lower = boxes[second];
  FacePair facing{blockId(first), blockId(second), axis.direction, {}};
  if (axis.ofA >= 0 && axis.ofB >= 0) {
    addPoint(facing, crossingOnA(upper, lower, axis), axis.gap, size, reach);
  } else {
    const bool onLower = axis.ofB >= 0;
    const Box& reference = onLower ? lower : upper;
    const Vec3 outward = onLower ? axis.direction : Vec3(-axis.direction);
    const double plane = reference.centre.dot(outward) + reference.reachAlong(outward);
    for (const Vec3& place : overlapOfFaces(reference, onLower ? upper : lower, outward, size)) {
      const double gap = place.dot(outward) - plane;
      addPoint(facing, onLower ? place : Vec3(place - outward * gap), gap, size, reach);
    }
  }
  if (facing.points.empty()) return {};
  return facing;
}

std::optional<FacePair> facingFloor(const Box& box, std::size_t block, double reach) {
  FacePair facing{blockId(block), kFloor, Vec3::UnitZ(), {}};
  const double size = 2.0 * box.half.minCoeff();
  // A block that lies on the floor has gaps at its lower corners alone, however far the reach goes.
  const double middle = box.centre.z();
  for (unsigned bits = 0; bits < 8; ++bits) {
    const Vec3 corner = box.corner(bits);
    if (corner.z() < middle) addPoint(facing, corner, corner.z(), size, reach);
  }
  if (facing.points.empty()) return {};
  return facing;
}

}  // namespace

std::vector<FacePair> facingBlocks(const Scene& scene, double reach_m) {
  std::vector<Box> boxes;
  std::vector<double> low;
  std::vector<double> high;
  double thickest = 0.0;
  for (const BlockSpec& block : scene.blocks) {
    boxes.push_back(boxOf(block));
    const double half = boxes.back().reachAlong(Vec3::UnitZ());
    low.push_back(block.centre.z() - half);
    high.push_back(block.centre.z() + half);
    thickest = std::max(thickest, block.dimensions.minCoeff());
  }
  std::vector<std::size_t> order(boxes.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return low[a] < low[b]; });
  std::vector<FacePair> result;
  const double margin = std::max(reach_m, tuning::kStaticTouchGap * thickest);
  for (std::size_t i = 0; i < order.size(); ++i) {
    const std::size_t a = order[i];
    if (scene.floor) {
      if (const auto facing = facingFloor(boxes[a], a, reach_m)) result.push_back(*facing);
    }
    for (std::size_t j = i + 1; j < order.size() && low[order[j]] <= high[a] + margin; ++j) {
      if (const auto facing = facingOf(boxes, a, order[j], reach_m)) result.push_back(*facing);
    }
  }
  std::sort(result.begin(), result.end(),
            [](const FacePair& a, const FacePair& b) { return std::pair(a.upper, a.lower) < std::pair(b.upper, b.lower); });
  return result;
}

}  // namespace springtower
