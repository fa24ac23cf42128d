#include "scenarios/random_blocks.h"

#include "core/elementary.h"
#include "core/geometry/oriented_box.h"
#include "core/scene/rotation.h"
#include "scenarios/random_scene.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace springtower {
namespace {

constexpr double kRadians = std::numbers::pi / 180.0;
constexpr double kSideVariety = 3.0;      // sides are this much longer or shorter than the manner's
constexpr double kDensity_kg_m3 = 600.0;  // wood
// Outlines that overlap by less than this share of a side are taken as side by side: rounding, a thousandth of what scenes may.
constexpr double kSideBySide = 1e-9;

double clampedSide(double side_m) {
  return std::clamp(side_m, kMinRandomSide_m, kMaxRandomSide_m);
}

// Angles in files have few decimals: a thousandth of a degree.
double wholeThousandths(double angle_deg) {
  return std::round(1e3 * angle_deg) / 1e3;
}

OrientedBox boxOf(const BlockSpec& block) {
  return orientedBox(block.centre, block.orientation, block.dimensions);
}

bool isApartAlong(const Vec3& axis, const OrientedBox& a, const OrientedBox& b, double slack) {
  return std::abs(axis.dot(b.centre - a.centre)) >= a.reachAlong(axis) + b.reachAlong(axis) - slack;
}

// Whether two boxes do not overlap (separating axis theorem).
bool areApart(const OrientedBox& a, const OrientedBox& b) {
  for (int i = 0; i < 3; ++i) {
    if (isApartAlong(a.axes.col(i), a, b, 0.0) || isApartAlong(b.axes.col(i), a, b, 0.0)) return true;
  }
  bool apart = false;
  forEachEdgeProduct([&](int i) { return a.axes.col(i); }, [&](int j) { return b.axes.col(j); }, 1e-8,
                     [&](int, int, const Vec3& axis) {
                       apart = isApartAlong(axis, a, b, 0.0);
                       return !apart;
                     });
  return apart;
}

// The same for the outlines, seen from above, of boxes that are turned about the vertical alone.
bool areOutlinesApart(const OrientedBox& a, const OrientedBox& b) {
  const double slack = kSideBySide * std::min(a.half.minCoeff(), b.half.minCoeff());
  for (int i = 0; i < 2; ++i) {
    if (isApartAlong(a.axes.col(i), a, b, slack) || isApartAlong(b.axes.col(i), a, b, slack)) return true;
  }
  return false;
}

// Lays a block on the highest of those below its outline, or on the floor, `gap` above it.
void layOn(std::vector<BlockSpec>& blocks, BlockSpec block, double gap_m) {
  const OrientedBox box = boxOf(block);
  double top = 0.0;
  for (const BlockSpec& other : blocks) {
    if (!areOutlinesApart(box, boxOf(other))) top = std::max(top, other.centre.z() + 0.5 * other.dimensions.z());
  }
  block.centre.z() = top + 0.5 * block.dimensions.z() + gap_m;
  blocks.push_back(block);
}

Vec3 randomTurn_deg(RandomDraw& draw) {
  if (draw.chance(0.15)) return Vec3::Zero();
  const Vec3 turn = draw.inBall(180.0);
  return {wholeThousandths(turn.x()), wholeThousandths(turn.y()), wholeThousandths(turn.z())};
}

// A velocity for the centre, and a spin whose corners go as fast at most.
void throwBlock(RandomDraw& draw, BlockSpec& block, double speed_m_s) {
  constexpr double kMaxSpin_rad_s = 500.0;
  block.velocity = draw.inBall(speed_m_s);
  if (draw.chance(0.3)) return;
  const double halfDiagonal = 0.5 * block.dimensions.norm();
  block.spin = draw.inBall(std::min(kMaxSpin_rad_s, speed_m_s / halfDiagonal));
}

// All blocks in columns and rows without gaps: flush neighbours of nearly one height, each on the one below.
std::vector<BlockSpec> drawRows(RandomDraw& draw, const BlockManner& manner, std::size_t count) {
  const BlockSpec first = drawBlock(draw, manner);
  const auto columns = static_cast<std::size_t>(draw.whole(2, 6));
  const double uneven = draw.chance(0.5) ? 0.0 : draw.logBetween(1e-4, 0.1);
  const bool bond = draw.chance(0.5);
  std::vector<BlockSpec> blocks;
  for (std::size_t b = 0; b < count; ++b) {
    BlockSpec block = drawBlock(draw, manner);
    block.dimensions = first.dimensions;
    block.dimensions.z() = clampedSide(block.dimensions.z() * (1.0 - uneven * draw.between(0.0, 1.0)));
    const std::size_t row = b / columns;
    const double shift = bond && row % 2 != 0 ? 0.5 : 0.0;
    block.centre.x() = (static_cast<double>(b % columns) + shift) * first.dimensions.x();
    layOn(blocks, block, 0.0);
  }
  return blocks;
}

// Puts a lane of boxes and its plank or planks at a place across, `y`. Returns the lane's width, m.
double addLane(RandomDraw& draw, const BlockManner& manner, double y, std::vector<BlockSpec>& blocks) {
  const double length = std::min(kMaxRandomSide_m, std::max(0.01, manner.side_m) * draw.between(1.5, 3.0));
  const double angle_deg = wholeThousandths(draw.between(20.0, 75.0));
  const double sine = elementary::sin(kRadians * angle_deg);
  const double cosine = elementary::cos(kRadians * angle_deg);
  const double share = draw.between(0.4, 0.95);  // of the plank's length, at which the edge touches it
  const double height = share * length * sine;
  const int boxes = std::min(draw.whole(1, 3), static_cast<int>(height / kMinRandomSide_m));
  BlockSpec box = drawBlock(draw, manner);
  box.dimensions.x() = clampedSide(length * draw.between(0.2, 0.8));
  box.dimensions.z() = height / boxes;
  double top = 0.0;
  for (int b = 0; b < boxes; ++b) {
    box.centre = Vec3(0.0, y, top + 0.5 * box.dimensions.z());
    box.mass = drawBlock(draw, manner).mass;
    top = box.centre.z() + 0.5 * box.dimensions.z();
    blocks.push_back(box);
  }
  BlockSpec plank = drawBlock(draw, manner);
  // Each draw has its own statement: the order of those within one is the compiler's.
  const double thin = draw.between(0.03, 0.15);
  const double narrow = draw.between(0.5, 1.0);
  plank.dimensions = Vec3(length, box.dimensions.y() * narrow, length * thin);
  plank.dimensions.y() = clampedSide(plank.dimensions.y());
  plank.dimensions.z() = clampedSide(plank.dimensions.z());
  const double thickness = plank.dimensions.z();
  // Its lower edge lies on the floor, and its lower face goes through the uppermost edge of the boxes.
  const double z = 0.5 * (length * sine + thickness * cosine);
  const double x = -0.5 * box.dimensions.x() + ((z - top) * cosine - 0.5 * thickness) / sine;
  const bool both = draw.chance(0.4) && (1.0 - share) * length * cosine < 0.4 * box.dimensions.x();
  for (const double side : {1.0, -1.0}) {
    plank.centre = Vec3(side * x, y, z);
    plank.orientation = orientationOfRotation(Vec3(0.0, -side * angle_deg, 0.0));
    blocks.push_back(plank);
    plank.mass = drawBlock(draw, manner).mass;
    if (!both) break;
  }
  return std::max(box.dimensions.y(), plank.dimensions.y());
}

// Turns a scene about the vertical; orientations as a file can have them.
void turnAll(std::vector<BlockSpec>& blocks, double angle_deg) {
  const Eigen::Quaterniond turn = orientationOfRotation(Vec3(0.0, 0.0, angle_deg));
  for (BlockSpec& block : blocks) {
    block.centre = turn * block.centre;
    block.orientation = orientationOfRotation(rotationOfOrientation((turn * block.orientation).normalized()));
  }
}

}  // namespace

BlockManner drawBlockManner(RandomDraw& draw) {
  BlockManner manner;
  manner.side_m = draw.logBetween(3.0 * kMinRandomSide_m, 0.35);
  manner.alike = draw.chance(0.4);
  for (double& side : manner.sides_m) side = clampedSide(manner.side_m * draw.logBetween(1.0 / kSideVariety, kSideVariety));
  manner.mass_kg = kDensity_kg_m3 * manner.side_m * manner.side_m * manner.side_m * draw.logBetween(0.3, 3.0);
  const std::size_t massClass = draw.pick({0.32, 0.31, 0.19, 0.12, 0.06});
  for (std::size_t i = 0; i < massClass; ++i) manner.massRatio *= 10.0;
  return manner;
}

BlockSpec drawBlock(RandomDraw& draw, const BlockManner& manner) {
  BlockSpec block;
  block.dimensions = manner.sides_m;
  for (double& side : block.dimensions) {
    const double other = clampedSide(manner.side_m * draw.logBetween(1.0 / kSideVariety, kSideVariety));
    if (!manner.alike) side = other;
  }
  const double root = std::sqrt(manner.massRatio);
  block.mass = manner.mass_kg * draw.logBetween(1.0 / root, root);
  return block;
}

std::vector<BlockSpec> drawStack(RandomDraw& draw, const BlockManner& manner, std::size_t count) {
  const std::size_t shape = draw.pick({0.5, 0.25, 0.25});
  if (shape == 2) return drawRows(draw, manner, count);
  // How far centres lie aside, in sides: a column that may fall, or a pile of several.
  const double spread = shape == 0 ? draw.logBetween(0.01, 0.5) : draw.between(0.5, 3.0);
  const std::size_t turns = draw.pick({0.4, 0.3, 0.3});  // none, quarters, any
  const double gap = draw.chance(0.15) ? manner.side_m * draw.logBetween(1e-4, 0.3) : 0.0;
  std::vector<BlockSpec> blocks;
  while (blocks.size() < count) {
    BlockSpec block = drawBlock(draw, manner);
    block.centre.x() = manner.side_m * draw.between(-spread, spread);
    block.centre.y() = manner.side_m * draw.between(-spread, spread);
    const double quarters = 90.0 * draw.whole(-1, 2);
    const double any = wholeThousandths(draw.between(-180.0, 180.0));
    block.orientation = orientationOfRotation(Vec3(0.0, 0.0, turns == 0 ? 0.0 : turns == 1 ? quarters : any));
    layOn(blocks, block, gap);
  }
  return blocks;
}

std::vector<BlockSpec> drawPlanks(RandomDraw& draw, const BlockManner& manner, std::size_t count) {
  constexpr std::size_t kMostOfALane = 5;
  const bool flush = draw.chance(0.3);
  std::vector<BlockSpec> blocks;
  double edge = 0.0;
  do {
    const std::size_t first = blocks.size();
    const double width = addLane(draw, manner, 0.0, blocks);
    const double y = first == 0 ? 0.0 : edge + 0.5 * width + (flush ? 0.0 : 0.1 * width);
    for (std::size_t b = first; b < blocks.size(); ++b) blocks[b].centre.y() = y;
    edge = y + 0.5 * width;
  } while (blocks.size() + kMostOfALane <= count);
  if (draw.chance(0.3)) turnAll(blocks, wholeThousandths(draw.between(-180.0, 180.0)));
  return blocks;
}

std::vector<BlockSpec> drawFlying(RandomDraw& draw, const BlockManner& manner, std::size_t count, bool floor) {
  constexpr double kInwards = 0.7;  // share of the speed that leads to the middle
  const double speed = draw.chance(0.05) ? 0.0 : draw.logBetween(0.01, kMaxRandomSpeed_m_s);
  const bool inwards = !floor || draw.chance(0.3);
  double region = manner.side_m * std::sqrt(static_cast<double>(count)) * draw.between(0.7, 2.0);
  std::vector<BlockSpec> blocks;
  std::vector<OrientedBox> boxes;
  while (blocks.size() < count) {
    BlockSpec block = drawBlock(draw, manner);
    block.orientation = orientationOfRotation(randomTurn_deg(draw));
    block.centre = draw.inBall(region);
    if (floor) block.centre.z() = boxOf(block).reach().z() + std::abs(block.centre.z());
    const OrientedBox box = boxOf(block);
    region *= 1.02;
    if (!std::all_of(boxes.begin(), boxes.end(), [&](const OrientedBox& other) { return areApart(box, other); })) continue;
    throwBlock(draw, block, inwards ? (1.0 - kInwards) * speed : speed);
    const double distance = block.centre.norm();
    if (inwards && distance > 0.0) block.velocity -= kInwards * speed * draw.between(0.0, 1.0) / distance * block.centre;
    boxes.push_back(box);
    blocks.push_back(block);
  }
  return blocks;
}

std::vector<BlockSpec> drawShot(RandomDraw& draw, const BlockManner& manner, std::size_t count) {
  const std::size_t shots = count > 3 && draw.chance(0.3) ? 2 : 1;
  const double speed = draw.logBetween(0.1, kMaxRandomSpeed_m_s);
  std::vector<BlockSpec> blocks = drawStack(draw, manner, count - shots);
  double left = 0.0;
  double top = 0.0;
  for (const BlockSpec& block : blocks) {
    const Vec3 reach = boxOf(block).reach();
    left = std::min(left, block.centre.x() - reach.x());
    top = std::max(top, block.centre.z() + reach.z());
  }
  for (std::size_t s = 0; s < shots; ++s) {
    BlockSpec block = drawBlock(draw, manner);
    block.orientation = orientationOfRotation(randomTurn_deg(draw));
    throwBlock(draw, block, 0.1 * speed);
    block.velocity.x() += 0.9 * speed;
    const Vec3 reach = boxOf(block).reach();
    const double height = draw.between(0.0, 1.0);  // three statements, as the order within one is the compiler's
    const double aside = draw.between(-1.0, 1.0);
    const double before = draw.logBetween(0.01, 2.0);
    block.centre =
        Vec3(left - reach.x() - manner.side_m * before, 0.3 * manner.side_m * aside, std::max(reach.z(), top * height));
    left = block.centre.x() - reach.x();
    blocks.push_back(block);
  }
  return blocks;
}

}  // namespace springtower
