#include "solver/statics/contacts.h"

#include "core/geometry/oriented_box.h"
#include "core/geometry/polygon.h"
#include "core/geometry/sweep.h"
#include "core/tuning.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

namespace springtower {
namespace {

// An axis that may separate two boxes: its direction is unit, from b to a.
struct Axis {
  Vec3 direction = Vec3::Zero();
  double gap = -std::numeric_limits<double>::infinity();
  int ofA = -1;  // index of the box's own axis it comes from, or -1
  int ofB = -1;
};

Axis axisAlong(const Vec3& unit, const OrientedBox& a, const OrientedBox& b, int ofA, int ofB) {
  const double distance = (a.centre - b.centre).dot(unit);
  return {distance < 0.0 ? Vec3(-unit) : unit, std::abs(distance) - a.reachAlong(unit) - b.reachAlong(unit), ofA, ofB};
}

Axis bestAxis(const OrientedBox& a, const OrientedBox& b, double slack) {
  Axis best;
  for (int i = 0; i < 3; ++i) {
    for (const Axis& axis : {axisAlong(b.axes.col(i), a, b, -1, i), axisAlong(a.axes.col(i), a, b, i, -1)}) {
      // The slack makes the choice between two faces that are flat on each other independent of rounding.
      if (axis.gap > best.gap + slack) best = axis;
    }
  }
  Axis edge;
  forEachEdgeProduct([&](int i) { return a.axes.col(i); }, [&](int j) { return b.axes.col(j); }, tuning::kStaticParallelSine,
                     [&](int i, int j, const Vec3& unit) {
                       const Axis axis = axisAlong(unit, a, b, i, j);
                       if (axis.gap > edge.gap) edge = axis;
                       return true;
                     });
  return edge.gap > best.gap + slack ? edge : best;
}

// The face of a box with the normal nearest to a direction: the axis it is perpendicular to, its centre and its normal.
struct Face {
  int across;
  Vec3 centre;
  Vec3 normal;
};

Face faceAlong(const OrientedBox& box, const Vec3& direction) {
  int across = 0;
  const Vec3 cosines = box.axes.transpose() * direction;
  for (int a = 1; a < 3; ++a) {
    if (std::abs(cosines[a]) > std::abs(cosines[across])) across = a;
  }
  const Vec3 normal = cosines[across] < 0.0 ? Vec3(-box.axes.col(across)) : Vec3(box.axes.col(across));
  return {across, box.centre + normal * box.half[across], normal};
}

double areaOf(const std::vector<Vec3>& polygon) {
  Vec3 twice = Vec3::Zero();
  for (std::size_t i = 2; i < polygon.size(); ++i) twice += (polygon[i - 1] - polygon[0]).cross(polygon[i] - polygon[0]);
  return 0.5 * twice.norm();
}

// The part of `incident`'s face over `reference`'s face; `normal` is unit, out of the reference face.
std::vector<Vec3> overlapOfFaces(const OrientedBox& reference, const OrientedBox& incident, const Vec3& normal, double size) {
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
    polygon = clippedBy(polygon, side, half + middle);
    polygon = clippedBy(polygon, Vec3(-side), half - middle);
  }
  const bool flat = face.normal.cross(other.normal).norm() < tuning::kStaticParallelSine;
  if (flat && areaOf(polygon) < tuning::kStaticTouchGap * size * size) polygon.clear();
  return polygon;
}

// Closest point of two crossing edges, on a's edge.
Vec3 crossingOnA(const OrientedBox& a, const OrientedBox& b, const Axis& axis) {
  const auto edgeCentre = [](const OrientedBox& box, const Vec3& towards, int along) {
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

std::optional<FacePair> facingOf(const Scene& scene, const std::vector<OrientedBox>& boxes, std::size_t first, std::size_t second,
                                 double reach) {
  if (scene.blocks[first].fixed && scene.blocks[second].fixed) return {};
  const double size = 2.0 * std::min(boxes[first].half.minCoeff(), boxes[second].half.minCoeff());
  Axis axis = bestAxis(boxes[first], boxes[second], tuning::kStaticFaceSlack * size);
  if (axis.gap > std::max(reach, tuning::kStaticTouchGap * size)) return {};
  // The block that lies higher along the axis is the upper one; on a fixed block, which is ground, any.
  const bool onFixed = scene.blocks[first].fixed || scene.blocks[second].fixed;
  if (onFixed ? scene.blocks[first].fixed : axis.direction.z() < -tuning::kStaticParallelSine) {
    std::swap(first, second);
    axis = {-axis.direction, axis.gap, axis.ofB, axis.ofA};
  }
  const OrientedBox& upper = boxes[first];
  const OrientedBox& lower = boxes[second];
  FacePair facing{blockId(first), blockId(second), axis.direction, {}};
  if (axis.ofA >= 0 && axis.ofB >= 0) {
    addPoint(facing, crossingOnA(upper, lower, axis), axis.gap, size, reach);
  } else {
    const bool onLower = axis.ofB >= 0;
    const OrientedBox& reference = onLower ? lower : upper;
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

std::optional<FacePair> facingFloor(const OrientedBox& box, std::size_t block, double reach) {
  FacePair facing{blockId(block), kFloor, Vec3::UnitZ(), {}};
  const double size = 2.0 * box.half.minCoeff();
  // A block that lies on the floor has potential contacts at its lower corners only, for any reach.
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
  std::vector<OrientedBox> boxes;
  std::vector<double> low;
  std::vector<double> high;
  double thickest = 0.0;
  for (const BlockSpec& block : scene.blocks) {
    boxes.push_back(orientedBox(block.centre, block.orientation, block.dimensions));
    const double half = boxes.back().reachAlong(Vec3::UnitZ());
    low.push_back(block.centre.z() - half);
    high.push_back(block.centre.z() + half);
    thickest = std::max(thickest, block.dimensions.minCoeff());
  }
  std::vector<FacePair> result;
  const double margin = std::max(reach_m, tuning::kStaticTouchGap * thickest);
  for (std::size_t b = 0; scene.floor && b < boxes.size(); ++b) {
    if (scene.blocks[b].fixed) continue;
    if (const auto facing = facingFloor(boxes[b], b, reach_m)) result.push_back(*facing);
  }
  forEachOverlap(low, high, margin, [&](std::size_t a, std::size_t b) {
    if (const auto facing = facingOf(scene, boxes, a, b, reach_m)) result.push_back(*facing);
  });
  std::sort(result.begin(), result.end(),
            [](const FacePair& a, const FacePair& b) { return std::pair(a.upper, a.lower) < std::pair(b.upper, b.lower); });
  return result;
}

}  // namespace springtower
