#include "core/error.h"
#include "core/limits.h"
#include "core/scene/scene.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <fmt/format.h>
#include <limits>
#include <numeric>
#include <string>
#include <vector>

namespace springtower {
namespace {

// Overlap that is rounding of the numbers in a file rather than a mistake, in least dimensions of the blocks.
constexpr double kAllowedOverlap = 1e-6;
constexpr std::array<const char*, 3> kAxisNames = {"x", "y", "z"};

struct Box {
  Vec3 centre;
  Eigen::Matrix3d axes;  // its own axes as columns
  Vec3 half;
  Vec3 reach;  // half lengths of its bounding box along the world's axes
};

Box boxOf(const BlockSpec& block) {
  Box box;
  box.centre = block.centre;
  box.axes = block.orientation.toRotationMatrix();
  box.half = 0.5 * block.dimensions;
  box.reach = box.axes.cwiseAbs() * box.half;
  return box;
}

double overlapAlong(const Vec3& direction, const Box& a, const Box& b) {
  const auto reachAlong = [&](const Box& box) { return (box.axes.transpose() * direction).cwiseAbs().dot(box.half); };
  return reachAlong(a) + reachAlong(b) - std::abs(direction.dot(b.centre - a.centre));
}

// How far two boxes would have to move apart to touch (separating axes: faces of each, products of edges); not positive when
// they are apart.
double overlapDepth(const Box& a, const Box& b) {
  double depth = std::numeric_limits<double>::infinity();
  for (Eigen::Index i = 0; i < 3; ++i) {
    depth = std::min({depth, overlapAlong(a.axes.col(i), a, b), overlapAlong(b.axes.col(i), a, b)});
  }
  for (Eigen::Index i = 0; i < 3 && depth > 0.0; ++i) {
    for (Eigen::Index j = 0; j < 3; ++j) {
      const Vec3 product = a.axes.col(i).cross(b.axes.col(j));
      const double length = product.norm();
      // Nearly parallel edges: the faces decide. Any direction is a valid witness, so rounding in this one does no harm.
      if (length > 1e-8) depth = std::min(depth, overlapAlong(product / length, a, b));
    }
  }
  return depth;
}

std::string nameOfBlock(const Scene& scene, std::size_t b) {
  const BlockSpec& block = scene.blocks[b];
  return block.row < 0 ? fmt::format("block {}", b) : fmt::format("block {} (row {}, position {})", b, block.row, block.position);
}

void checkVector(const Vec3& value, const Range& range, const std::string& where) {
  for (std::size_t a = 0; a < 3; ++a) {
    requireInRange(value[static_cast<Eigen::Index>(a)], range, fmt::format("{} {}", where, kAxisNames[a]));
  }
}

bool isInside(const Vec3& value, const Range& range) {
  return isInside(value.x(), range) && isInside(value.y(), range) && isInside(value.z(), range);
}

// Composes its messages only when something is wrong, as a scene may have a hundred thousand blocks.
void checkBlock(const Scene& scene, std::size_t b, std::string_view source) {
  constexpr Range kUnit{1.0 - 1e-9, 1.0 + 1e-9, ""};
  const BlockSpec& block = scene.blocks[b];
  const double length = block.orientation.norm();
  if (isInside(block.centre, kPlaceRange) && isInside(block.dimensions, kDimensionRange) &&
      isInside(block.velocity, kVelocityRange) && isInside(block.spin, kSpinRange) && isInside(block.mass, kMassRange) &&
      isInside(length, kUnit)) {
    return;
  }
  const std::string where = fmt::format("{}: {}", source, nameOfBlock(scene, b));
  checkVector(block.centre, kPlaceRange, where + ": centre");
  checkVector(block.dimensions, kDimensionRange, where + ": dimension");
  checkVector(block.velocity, kVelocityRange, where + ": velocity");
  checkVector(block.spin, kSpinRange, where + ": spin");
  requireInRange(block.mass, kMassRange, where + ": mass");
  requireInRange(length, kUnit, where + ": length of the orientation's quaternion");
}

void checkGravity(const Gravity& gravity, std::string_view source) {
  requireInRange(gravity.magnitude, kGravityRange, fmt::format("{}: gravity: magnitude", source));
  requireInRange(gravity.tilt_deg, kTiltRange, fmt::format("{}: gravity: tilt", source));
  requireInRange(gravity.direction_deg, kDirectionRange, fmt::format("{}: gravity: direction", source));
  requireInRange(gravity.sway_deg, kTiltRange, fmt::format("{}: gravity: sway", source));
  requireInRange(gravity.sway_hz, kFrequencyRange, fmt::format("{}: gravity: frequency of the sway", source));
}

void checkForce(const UserForce& force, std::size_t blocks, const std::string& where) {
  requireInRange(force.block, {0.0, static_cast<double>(blocks) - 1.0, ""}, where + ": block");
  requireInRange(force.corner, {-1.0, 7.0, "(-1 is the centre)"}, where + ": corner");
  checkVector(force.force, kForceRange, where + ": force");
  requireInRange(force.start_s, kTimeRange, where + ": start");
  requireInRange(force.end_s, {force.start_s, kTimeRange.most, kTimeRange.unit}, where + ": end");
}

void checkFloor(const Scene& scene, const std::vector<Box>& boxes, std::string_view source) {
  for (std::size_t b = 0; b < boxes.size(); ++b) {
    const double depth = boxes[b].reach.z() - boxes[b].centre.z();
    if (depth <= kAllowedOverlap * scene.blocks[b].dimensions.minCoeff()) continue;
    throw InputError(fmt::format("{}: {} starts {:.4g} mm inside the floor z = 0, allowed is touching it", source,
                                 nameOfBlock(scene, b), 1e3 * depth));
  }
}

// Whether everything about a scene is its own mirror image in the plane y = 0.
void checkPlane(const Scene& scene, std::string_view source) {
  constexpr double kRounding = 1e-9;  // m, m/s, rad/s, N, m/s2 and cosines
  const auto require = [&](double found, const std::string& where) {
    requireInRange(found, {-kRounding, kRounding, "for a motion in the plane y = 0"}, fmt::format("{}: {}", source, where));
  };
  for (std::size_t b = 0; b < scene.blocks.size(); ++b) {
    const BlockSpec& block = scene.blocks[b];
    const std::string where = nameOfBlock(scene, b);
    require(block.centre.y(), where + ": centre y");
    require(1.0 - block.orientation.toRotationMatrix().row(1).cwiseAbs().maxCoeff(), where + ": turn out of the plane");
    require(block.velocity.y(), where + ": velocity y");
    require(block.spin.x(), where + ": spin x");
    require(block.spin.z(), where + ": spin z");
  }
  for (std::size_t f = 0; f < scene.forces.size(); ++f) {
    const UserForce& force = scene.forces[f];
    require(force.force.y(), fmt::format("force {}: force y", f));
    require(force.corner + 1.0, fmt::format("force {}: corner, counted from 1,", f));
  }
  require(scene.gravity.at(0.0).y(), "gravity: y");
}

// The axis along which the blocks are spread most, which leaves the fewest neighbours in a sweep.
Eigen::Index widestAxis(const std::vector<Box>& boxes) {
  Vec3 sum = Vec3::Zero();
  Vec3 sumOfSquares = Vec3::Zero();
  for (const Box& box : boxes) {
    const Vec3 place = box.centre - boxes.front().centre;
    sum += place;
    sumOfSquares += place.cwiseAbs2();
  }
  Eigen::Index widest = 0;
  (sumOfSquares - sum.cwiseAbs2() / static_cast<double>(boxes.size())).maxCoeff(&widest);
  return widest;
}

void checkPairs(const Scene& scene, const std::vector<Box>& boxes, std::string_view source) {
  const Eigen::Index axis = widestAxis(boxes);
  const auto low = [&](std::size_t b) { return boxes[b].centre[axis] - boxes[b].reach[axis]; };
  std::vector<std::size_t> order(boxes.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return low(a) < low(b); });
  for (std::size_t i = 0; i < order.size(); ++i) {
    const Box& box = boxes[order[i]];
    const double high = box.centre[axis] + box.reach[axis];
    for (std::size_t j = i + 1; j < order.size() && low(order[j]) < high; ++j) {
      const Box& other = boxes[order[j]];
      const auto [first, second] = std::minmax(order[i], order[j]);
      if (((other.centre - box.centre).cwiseAbs().array() >= (box.reach + other.reach).array()).any()) continue;
      const double depth = overlapDepth(boxes[first], boxes[second]);
      const double size = std::min(scene.blocks[first].dimensions.minCoeff(), scene.blocks[second].dimensions.minCoeff());
      if (depth <= kAllowedOverlap * size) continue;
      throw InputError(fmt::format("{}: {} and {} start {:.4g} mm inside each other, allowed is touching", source,
                                   nameOfBlock(scene, first), nameOfBlock(scene, second), 1e3 * depth));
    }
  }
}

}  // namespace

void checkScene(const Scene& scene, std::string_view source) {
  checkSettings(scene.settings, source);
  checkGravity(scene.gravity, source);
  requireInRange(scene.seconds, kSecondsRange, fmt::format("{}: seconds", source));
  requireInRange(scene.staticFriction, kFrictionRange, fmt::format("{}: static friction", source));
  requireInRange(scene.kineticFriction, {0.0, scene.staticFriction, "(the static one)"},
                 fmt::format("{}: kinetic friction", source));
  requireInRange(static_cast<double>(scene.blocks.size()), {1.0, static_cast<double>(kMaxBlocks), ""},
                 fmt::format("{}: number of blocks", source));
  std::vector<Box> boxes;
  boxes.reserve(scene.blocks.size());
  for (std::size_t b = 0; b < scene.blocks.size(); ++b) {
    checkBlock(scene, b, source);
    boxes.push_back(boxOf(scene.blocks[b]));
  }
  for (std::size_t f = 0; f < scene.forces.size(); ++f) {
    checkForce(scene.forces[f], scene.blocks.size(), fmt::format("{}: force {}", source, f));
  }
  if (scene.plane) checkPlane(scene, source);
  checkMoves(scene, source);
  if (scene.floor) checkFloor(scene, boxes, source);
  checkPairs(scene, boxes, source);
}

}  // namespace springtower
