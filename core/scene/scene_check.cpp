#include "core/error.h"
#include "core/geometry/oriented_box.h"
#include "core/geometry/sweep.h"
#include "core/limits.h"
#include "core/scene/input_check.h"
#include "core/scene/scene.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <fmt/format.h>
#include <limits>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace springtower {
namespace {

// Overlap that is rounding of the numbers in a file, in least dimensions of the blocks.
constexpr double kRoundedOverlap = 1e-6;
// Overlap of undeformed blocks at the centres that they have at rest, in tolerances: contacts of uneven rows are compressed
// by 1.6 at most, and the blocks themselves by as much again.
constexpr double kRestOverlap = 4.0;
constexpr double kMaxOverlap = 0.1;  // in least dimensions
constexpr double kMaxStrain = 0.01;  // in least dimensions
constexpr std::array<const char*, 3> kAxisNames = {"x", "y", "z"};

double overlapAlong(const Vec3& direction, const OrientedBox& a, const OrientedBox& b) {
  return a.reachAlong(direction) + b.reachAlong(direction) - std::abs(direction.dot(b.centre - a.centre));
}

// How far two boxes would have to move apart to touch; not positive when they are apart. Any direction is a valid witness, so
// rounding in one does no harm.
double overlapDepth(const OrientedBox& a, const OrientedBox& b) {
  constexpr double kLeastSine = 1e-8;
  double depth = std::numeric_limits<double>::infinity();
  for (Eigen::Index i = 0; i < 3; ++i) {
    depth = std::min({depth, overlapAlong(a.axes.col(i), a, b), overlapAlong(b.axes.col(i), a, b)});
  }
  if (depth <= 0.0) return depth;
  forEachEdgeProduct([&](int i) { return a.axes.col(i); }, [&](int j) { return b.axes.col(j); }, kLeastSine,
                     [&](int, int, const Vec3& axis) {
                       depth = std::min(depth, overlapAlong(axis, a, b));
                       return true;
                     });
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

// Composes its messages only when something is wrong, as a scene may have two hundred thousand blocks.
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

void checkFixed(const Scene& scene, std::string_view source) {
  for (std::size_t b = 0; b < scene.blocks.size(); ++b) {
    const BlockSpec& block = scene.blocks[b];
    if (!block.fixed || (block.velocity.isZero(0.0) && block.spin.isZero(0.0))) continue;
    throw InputError(
        fmt::format("{}: {}: expected no velocity and no spin for a fixed block, got one", source, nameOfBlock(scene, b)));
  }
  if (std::all_of(scene.blocks.begin(), scene.blocks.end(), [](const BlockSpec& block) { return block.fixed; }))
    throw InputError(fmt::format("{}: expected at least one block that is not fixed, got fixed blocks only", source));
}

// A drive that moves something, of a block that nothing else moves.
void checkDrive(const Scene& scene, const Drive& drive, const std::string& where) {
  requireInRange(drive.block, {0.0, static_cast<double>(scene.blocks.size()) - 1.0, ""}, where + ": block");
  const auto block = static_cast<std::size_t>(drive.block);
  if (!scene.blocks[block].fixed)
    throw InputError(
        fmt::format("{}: block: expected a fixed block, got {}, which is not fixed", where, nameOfBlock(scene, block)));
  checkVector(drive.velocity, kVelocityRange, where + ": velocity");
  checkVector(drive.spin, kSpinRange, where + ": spin");
  checkVector(drive.amplitude, kAmplitudeRange, where + ": amplitude");
  requireInRange(drive.frequency_hz, kFrequencyRange, where + ": frequency");
  requireInRange(drive.start_s, kTimeRange, where + ": start");
  requireInRange(drive.end_s, {drive.start_s, kTimeRange.most, kTimeRange.unit}, where + ": end");
  if (drive.amplitude.isZero(0.0) != (drive.frequency_hz == 0.0))
    throw InputError(where + ": expected both an amplitude and a frequency or neither, got one without the other");
  if (drive.mostSpeed_m_s(0.0) == 0.0 && drive.spin.isZero(0.0))
    throw InputError(where + ": expected at least one of a velocity, a spin and an amplitude, got none");
  requireInRange(drive.mostSpeed_m_s(0.5 * scene.blocks[block].dimensions.norm()),
                 {0.0, kVelocityRange.most, kVelocityRange.unit}, where + ": fastest corner");
}

// The tolerance that the overlaps of a rest state may come from, m.
double restTolerance_m(const Scene& scene) {
  return std::max(toleranceOf(scene), kBlockTolerance_m / kBlockHeight_m * blockHeightOf(scene));
}

double overlapAllowed(double tolerance_m, double side_m) {
  return std::max(kRoundedOverlap * side_m, std::min(kRestOverlap * tolerance_m, kMaxOverlap * side_m));
}

double strainAllowed(double tolerance_m, double side_m) {
  return std::max(kMaxStrain * side_m, std::min(kRestOverlap * tolerance_m, kMaxOverlap * side_m));
}

void checkStrains(const Scene& scene, std::string_view source) {
  const double tolerance_m = restTolerance_m(scene);
  for (std::size_t b = 0; b < scene.blocks.size(); ++b) {
    const BlockSpec& block = scene.blocks[b];
    if (!block.strain) continue;
    const double allowed_m = strainAllowed(tolerance_m, block.dimensions.minCoeff());
    for (std::size_t c = 0; c < kCorners; ++c) {
      const double apart_m = (*block.strain)[c].norm();
      if (apart_m <= allowed_m) continue;
      throw InputError(
          fmt::format("{}: {}: corner {}: expected up to {:.4g} mm from that of a cuboid of {:g} x {:g} x {:g} m (corners in "
                      "the order of run --poses), got {:.4g} mm",
                      source, nameOfBlock(scene, b), c, 1e3 * allowed_m, block.dimensions.x(), block.dimensions.y(),
                      block.dimensions.z(), 1e3 * apart_m));
    }
  }
}

void checkFloor(const Scene& scene, const std::vector<OrientedBox>& boxes, std::string_view source) {
  const double tolerance_m = restTolerance_m(scene);
  for (std::size_t b = 0; b < boxes.size(); ++b) {
    if (scene.blocks[b].fixed) continue;
    const double depth = boxes[b].reach().z() - boxes[b].centre.z();
    const double allowed_m = overlapAllowed(tolerance_m, scene.blocks[b].dimensions.minCoeff());
    if (depth <= allowed_m) continue;
    throw InputError(fmt::format("{}: {}: expected a start up to {:.4g} mm inside the floor z = 0, as at rest, got {:.4g} mm",
                                 source, nameOfBlock(scene, b), 1e3 * allowed_m, 1e3 * depth));
  }
}

// A number that would lead out of the plane y = 0.
void requireNone(double found, std::string_view where) {
  constexpr double kRounding = 1e-9;  // m, m/s, rad/s, N, m/s2 and cosines
  requireInRange(found, {-kRounding, kRounding, "for a motion in the plane y = 0"}, where);
}

// Whether everything about a scene is its own mirror image in the plane y = 0.
void checkPlane(const Scene& scene, std::string_view source) {
  const auto require = [&](double found, const std::string& where) { requireNone(found, fmt::format("{}: {}", source, where)); };
  for (std::size_t b = 0; b < scene.blocks.size(); ++b) {
    const BlockSpec& block = scene.blocks[b];
    const std::string where = nameOfBlock(scene, b);
    require(block.centre.y(), where + ": centre y");
    checkTurnInPlane(block.orientation, fmt::format("{}: {}", source, where));
    require(block.velocity.y(), where + ": velocity y");
    require(block.spin.x(), where + ": spin x");
    require(block.spin.z(), where + ": spin z");
  }
  for (std::size_t d = 0; d < scene.drives.size(); ++d) {
    const std::string where = fmt::format("drive {}", d);
    require(scene.drives[d].velocity.y(), where + ": velocity y");
    require(scene.drives[d].amplitude.y(), where + ": amplitude y");
    require(scene.drives[d].spin.x(), where + ": spin x");
    require(scene.drives[d].spin.z(), where + ": spin z");
  }
  for (std::size_t f = 0; f < scene.forces.size(); ++f) {
    checkForceInPlane(scene.forces[f], fmt::format("{}: force {}", source, f));
  }
  checkGravityInPlane(scene.gravity, source);
}

void checkPair(const Scene& scene, const std::vector<OrientedBox>& boxes, double tolerance_m, std::size_t one, std::size_t other,
               std::string_view source) {
  const auto [first, second] = std::minmax(one, other);
  if (scene.blocks[first].fixed && scene.blocks[second].fixed) return;
  const OrientedBox& a = boxes[first];
  const OrientedBox& b = boxes[second];
  if (((a.centre - b.centre).cwiseAbs().array() >= (a.reach() + b.reach()).array()).any()) return;
  const double depth = overlapDepth(a, b);
  const double size = std::min(scene.blocks[first].dimensions.minCoeff(), scene.blocks[second].dimensions.minCoeff());
  const double allowed_m = overlapAllowed(tolerance_m, size);
  if (depth <= allowed_m) return;
  throw InputError(fmt::format("{}: {} and {}: expected a start up to {:.4g} mm inside each other, as at rest, got {:.4g} mm",
                               source, nameOfBlock(scene, first), nameOfBlock(scene, second), 1e3 * allowed_m, 1e3 * depth));
}

void checkPairs(const Scene& scene, const std::vector<OrientedBox>& boxes, std::string_view source) {
  const Eigen::Index axis = widestAxis(boxes.size(), [&](std::size_t b) { return boxes[b].centre; });
  std::vector<double> lower;
  std::vector<double> upper;
  for (const OrientedBox& box : boxes) {
    const double reach = box.reach()[axis];
    lower.push_back(box.centre[axis] - reach);
    upper.push_back(box.centre[axis] + reach);
  }
  const double tolerance_m = restTolerance_m(scene);
  forEachOverlap(lower, upper, 0.0, [&](std::size_t a, std::size_t b) { checkPair(scene, boxes, tolerance_m, a, b, source); });
}

}  // namespace

double allowedOverlap_m(const Scene& scene, double side_m) {
  return overlapAllowed(restTolerance_m(scene), side_m);
}

void checkGravity(const Gravity& gravity, std::string_view source) {
  requireInRange(gravity.magnitude, kGravityRange, fmt::format("{}: gravity: magnitude", source));
  requireInRange(gravity.tilt_deg, kTiltRange, fmt::format("{}: gravity: tilt", source));
  requireInRange(gravity.direction_deg, kDirectionRange, fmt::format("{}: gravity: direction", source));
  requireInRange(gravity.sway_deg, kTiltRange, fmt::format("{}: gravity: sway", source));
  requireInRange(gravity.sway_hz, kFrequencyRange, fmt::format("{}: gravity: frequency of the sway", source));
}

void checkForce(const UserForce& force, std::span<const Vec3> dimensions, std::string_view source) {
  const std::string where(source);
  requireInRange(force.block, {0.0, static_cast<double>(dimensions.size()) - 1.0, ""}, where + ": block");
  requireInRange(force.corner, {-1.0, 7.0, "(-1 is the centre)"}, where + ": corner");
  if (force.point) {
    requireInRange(force.corner, {-1.0, -1.0, "(a force at a point acts at no corner)"}, where + ": corner");
    const Vec3 half = 0.5 * dimensions[static_cast<std::size_t>(force.block)];
    for (std::size_t a = 0; a < 3; ++a) {
      const auto axis = static_cast<Eigen::Index>(a);
      requireInRange((*force.point)[axis], {-half[axis], half[axis], "m (within the block)"},
                     fmt::format("{}: point {}", where, kAxisNames[a]));
    }
  }
  checkVector(force.force, kForceRange, where + ": force");
  checkVector(force.torque, kTorqueRange, where + ": torque");
  if (force.forceAtEnd) checkVector(*force.forceAtEnd, kForceRange, where + ": force at the end");
  if (force.torqueAtEnd) checkVector(*force.torqueAtEnd, kTorqueRange, where + ": torque at the end");
  requireInRange(force.start_s, kTimeRange, where + ": start");
  requireInRange(force.end_s, {force.start_s, kTimeRange.most, kTimeRange.unit}, where + ": end");
}

void requireBlock(std::size_t block, std::size_t blocks, std::string_view source) {
  if (block < blocks) return;
  throw InputError(fmt::format("{}: expected a block of the scene, from 0 to {}, got {}", source,
                               static_cast<std::int64_t>(blocks) - 1, block));
}

void requireMovable(const Scene& scene, std::size_t block, std::string_view source) {
  if (!scene.blocks[block].fixed) return;
  throw InputError(fmt::format("{}: expected a block that moves, got {}, which is fixed", source, nameOfBlock(scene, block)));
}

namespace {

void checkForces(const Scene& scene, std::string_view source) {
  if (scene.forces.empty()) return;
  std::vector<Vec3> dimensions;
  dimensions.reserve(scene.blocks.size());
  for (const BlockSpec& block : scene.blocks) dimensions.push_back(block.dimensions);
  for (std::size_t f = 0; f < scene.forces.size(); ++f) {
    const std::string where = fmt::format("{}: force {}", source, f);
    checkForce(scene.forces[f], dimensions, where);
    requireMovable(scene, static_cast<std::size_t>(scene.forces[f].block), where + ": block");
  }
}

}  // namespace

void checkFriction(double staticFriction, double kineticFriction, std::string_view source) {
  requireInRange(staticFriction, kFrictionRange, fmt::format("{}: static friction", source));
  requireInRange(kineticFriction, {0.0, staticFriction, "(the static one)"}, fmt::format("{}: kinetic friction", source));
}

void checkFrictions(const Scene& scene, std::string_view source) {
  checkFriction(scene.staticFriction, scene.kineticFriction, source);
  const auto check = [&](const Friction& friction, const std::string& where) {
    checkFriction(friction.staticFriction, friction.kineticFriction, fmt::format("{}: {}", source, where));
  };
  if (scene.floorFriction) check(*scene.floorFriction, "floor");
  for (std::size_t b = 0; b < scene.blocks.size(); ++b) {
    if (scene.blocks[b].friction) check(*scene.blocks[b].friction, nameOfBlock(scene, b));
  }
  std::vector<std::pair<int, int>> known;
  const double last = static_cast<double>(scene.blocks.size()) - 1.0;
  for (std::size_t i = 0; i < scene.frictionPairs.size(); ++i) {
    const FrictionPair& pair = scene.frictionPairs[i];
    const std::string where = fmt::format("friction pair {}", i);
    for (const int block : {pair.a, pair.b})
      requireInRange(block, {-1.0, last, "(-1 is the floor)"}, fmt::format("{}: {}: block", source, where));
    if (pair.a == pair.b) throw InputError(fmt::format("{}: {}: expected two blocks, got block {} twice", source, where, pair.a));
    check(pair.friction, where);
    known.emplace_back(std::minmax(pair.a, pair.b));
  }
  std::sort(known.begin(), known.end());
  const auto twice = std::adjacent_find(known.begin(), known.end());
  if (twice == known.end()) return;
  throw InputError(
      fmt::format("{}: expected one friction pair of blocks {} and {}, got two", source, twice->first, twice->second));
}

void checkForceInPlane(const UserForce& force, std::string_view source) {
  requireNone(force.force.y(), fmt::format("{}: force y", source));
  if (force.forceAtEnd) requireNone(force.forceAtEnd->y(), fmt::format("{}: force at the end y", source));
  if (force.point) requireNone(force.point->norm(), fmt::format("{}: point, its distance from the centre,", source));
  for (const Vec3& torque : {force.torque, force.torqueAtEnd.value_or(force.torque)}) {
    requireNone(torque.x(), fmt::format("{}: torque x", source));
    requireNone(torque.z(), fmt::format("{}: torque z", source));
  }
  requireNone(force.corner + 1.0, fmt::format("{}: corner, counted from 1,", source));
}

void checkGravityInPlane(const Gravity& gravity, std::string_view source) {
  requireNone(gravity.at(0.0).y(), fmt::format("{}: gravity: y", source));
}

void checkTurnInPlane(const Eigen::Quaterniond& turn, std::string_view source) {
  requireNone(1.0 - turn.toRotationMatrix().row(1).cwiseAbs().maxCoeff(), fmt::format("{}: turn out of the plane", source));
}

void checkScene(const Scene& scene, std::string_view source) {
  checkSettings(scene.settings, source);
  checkGravity(scene.gravity, source);
  requireInRange(scene.seconds, kSecondsRange, fmt::format("{}: seconds", source));
  checkFrictions(scene, source);
  requireInRange(scene.restitution, kRestitutionRange, fmt::format("{}: restitution", source));
  requireInRange(static_cast<double>(scene.blocks.size()), {1.0, static_cast<double>(kMaxBlocks), ""},
                 fmt::format("{}: number of blocks", source));
  std::vector<OrientedBox> boxes;
  boxes.reserve(scene.blocks.size());
  for (std::size_t b = 0; b < scene.blocks.size(); ++b) {
    checkBlock(scene, b, source);
    boxes.push_back(orientedBox(scene.blocks[b].centre, scene.blocks[b].orientation, scene.blocks[b].dimensions));
  }
  checkForces(scene, source);
  checkStrains(scene, source);
  checkFixed(scene, source);
  for (std::size_t d = 0; d < scene.drives.size(); ++d)
    checkDrive(scene, scene.drives[d], fmt::format("{}: drive {}", source, d));
  if (scene.plane) checkPlane(scene, source);
  checkMoves(scene, source);
  if (scene.floor) checkFloor(scene, boxes, source);
  checkPairs(scene, boxes, source);
}

}  // namespace springtower
