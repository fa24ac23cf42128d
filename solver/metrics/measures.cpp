#include "solver/metrics/measures.h"

#include "core/elementary.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>
#include <numbers>
#include <numeric>

namespace springtower {
namespace {

constexpr double kDegreesPerRadian = 180.0 / std::numbers::pi;

// The trace of the rotation from one box to the other, 1 + 2 cos(angle): saves the arc cosine for blocks that stand.
double turnTrace(const FittedBox& from, const FittedBox& to) {
  return from.axis[0].dot(to.axis[0]) + from.axis[1].dot(to.axis[1]) + from.axis[2].dot(to.axis[2]);
}

// A block's shortest side, and the next.
struct Sides {
  double least;
  double middle;
};
Sides sidesOf(const Vec3& dimensions) {
  return {dimensions.minCoeff(),
          std::max(std::min(dimensions.x(), dimensions.y()), std::min(std::max(dimensions.x(), dimensions.y()), dimensions.z()))};
}

// The axis of a block that is nearest to the vertical.
std::size_t uprightAxis(const ParticleArray& position, std::size_t block) {
  std::size_t upright = 0;
  double best = -1.0;
  for (std::size_t a = 0; a < 3; ++a) {
    const Vec3 edge = meanEdge(position, block, a);
    const double slope = std::abs(edge.z()) / edge.norm();
    if (slope > best) {
      best = slope;
      upright = a;
    }
  }
  return upright;
}

// Bounds of a block's corners along one axis.
struct Interval {
  double low;
  double high;
};
Interval bounds(const ParticleArray& position, std::size_t block, std::size_t axis) {
  const auto [low, high] = std::minmax_element(position.values(axis, block), position.values(axis, block) + kCorners);
  return {*low, *high};
}

bool overlap(const Interval& a, const Interval& b) {
  return a.low < b.high && b.low < a.high;
}

}  // namespace

std::vector<FittedBox> fittedBoxes(const ParticleArray& position) {
  std::vector<FittedBox> boxes;
  boxes.reserve(position.blockCount());
  for (std::size_t b = 0; b < position.blockCount(); ++b) boxes.push_back(fittedBox(position, b));
  return boxes;
}

Standing standing(const BlockModel& model, std::span<const FittedBox> start, const ParticleArray& position,
                  std::span<const std::uint8_t> leftOut) {
  static const double leastTrace = 1.0 + 2.0 * elementary::cos(kFallTurn_deg / kDegreesPerRadian);
  for (std::size_t b = 0; b < position.blockCount(); ++b) {
    if (model.isFixed(b) || (!leftOut.empty() && leftOut[b] != 0)) continue;
    const FittedBox box = fittedBox(position, b);
    const Vec3 move = box.centre - start[b].centre;
    // Written so that a value that is not finite counts as fallen.
    const Sides sides = sidesOf(model.dimensions[b]);
    if (!(-move.z() <= kFallDropInLeastSides * sides.least)) return {false, blockId(b), Fall::lower, -move.z()};
    const double shift = elementary::hypot(move.x(), move.y());
    if (!(shift <= kFallShiftInMiddleSides * sides.middle)) return {false, blockId(b), Fall::sideways, shift};
    const double trace = turnTrace(start[b], box);
    if (!(trace >= leastTrace)) {
      const double angle = elementary::acos(std::clamp(0.5 * (trace - 1.0), -1.0, 1.0));
      return {false, blockId(b), Fall::turned, angle * kDegreesPerRadian};
    }
  }
  return {};
}

std::string describe(const Standing& standing) {
  switch (standing.fall) {
    case Fall::lower:
      return fmt::format("block {} is {:.3g} mm lower than at the start", index(standing.block), 1e3 * standing.amount);
    case Fall::sideways:
      return fmt::format("block {} is {:.3g} mm aside from its start", index(standing.block), 1e3 * standing.amount);
    case Fall::turned:
      return fmt::format("block {} is turned by {:.3g} degrees", index(standing.block), standing.amount);
    case Fall::none:
      break;
  }
  return "all blocks stand";
}

ParticleArray stackedReference(const ParticleArray& start, std::span<const int> row, bool floor) {
  ParticleArray closed = start;
  std::vector<std::size_t> order(start.blockCount());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return row[a] < row[b]; });

  // Blocks are in order of rows; [belowBegin, belowEnd) of `order` are those of the row below.
  std::size_t belowBegin = 0;
  std::size_t belowEnd = 0;
  std::size_t rowBegin = 0;
  for (std::size_t i = 0; i < order.size(); ++i) {
    const std::size_t b = order[i];
    if (row[b] != row[order[rowBegin]]) {
      belowBegin = rowBegin;
      belowEnd = i;
      rowBegin = i;
    }
    if (row[b] < 0) continue;
    double support = row[b] == 0 && floor ? 0.0 : -std::numeric_limits<double>::infinity();
    for (std::size_t k = belowBegin; k < belowEnd; ++k) {
      const std::size_t below = order[k];
      if (row[below] != row[b] - 1 || row[below] < 0) continue;
      if (!overlap(bounds(start, b, 0), bounds(start, below, 0)) || !overlap(bounds(start, b, 1), bounds(start, below, 1))) {
        continue;
      }
      support = std::max(support, bounds(closed, below, 2).high);
    }
    const double drop = bounds(start, b, 2).low - support;
    if (!std::isfinite(drop)) continue;
    for (std::size_t c = 0; c < kCorners; ++c) closed.add(b, c, Vec3(0.0, 0.0, -drop));
  }
  return closed;
}

std::vector<BlockId> bottomRow(const BlockModel& model, const ParticleArray& start, std::span<const int> row) {
  std::vector<BlockId> blocks;
  for (std::size_t b = 0; b < row.size(); ++b) {
    if (row[b] == 0) blocks.push_back(blockId(b));
  }
  if (!blocks.empty()) return blocks;
  double lowest = std::numeric_limits<double>::infinity();
  for (std::size_t b = 0; b < start.blockCount(); ++b) {
    if (!model.isFixed(b)) lowest = std::min(lowest, centre(start, b).z());
  }
  for (std::size_t b = 0; b < start.blockCount(); ++b) {
    if (!model.isFixed(b) && centre(start, b).z() - lowest <= 0.25 * model.dimensions[b].z()) blocks.push_back(blockId(b));
  }
  return blocks;
}

double meanRowCompression(const BlockModel& model, const ParticleArray& start, const ParticleArray& position,
                          std::span<const BlockId> blocks) {
  if (blocks.empty()) return 0.0;
  double lost = 0.0;
  for (const BlockId id : blocks) {
    const std::size_t b = index(id);
    const std::size_t axis = uprightAxis(start, b);
    lost += model.dimensions[b][static_cast<Eigen::Index>(axis)] - meanEdge(position, b, axis).norm();
  }
  return lost / static_cast<double>(blocks.size());
}

double maxStrain(const BlockModel& model, const ParticleArray& position) {
  // Extremes of (length / rest length)^2, so that one square root is enough.
  double least = 1.0;
  double most = 1.0;
  for (std::size_t b = 0; b < position.blockCount(); ++b) {
    const double* x = position.values(0, b);
    const double* y = position.values(1, b);
    const double* z = position.values(2, b);
    for (std::size_t group = 1; group <= kSpringGroups; ++group) {
      double shortest = std::numeric_limits<double>::infinity();
      double longest = 0.0;
      for (std::size_t c = 0; c < kCorners; ++c) {
        const std::size_t other = c ^ group;
        if (other < c) continue;
        const double dx = x[c] - x[other];
        const double dy = y[c] - y[other];
        const double dz = z[c] - z[other];
        const double squared = dx * dx + dy * dy + dz * dz;
        shortest = std::min(shortest, squared);
        longest = std::max(longest, squared);
      }
      const double rest = model.restLength[group - 1][b];
      const double scale = 1.0 / (rest * rest);
      least = std::min(least, shortest * scale);
      most = std::max(most, longest * scale);
    }
  }
  return std::max(std::sqrt(most) - 1.0, 1.0 - std::sqrt(least));
}

double largestCornerMove(const ParticleArray& reference, const ParticleArray& position) {
  double largest = 0.0;
  for (std::size_t i = 0; i < position.component[0].size(); ++i) {
    const double dx = position.component[0][i] - reference.component[0][i];
    const double dy = position.component[1][i] - reference.component[1][i];
    const double dz = position.component[2][i] - reference.component[2][i];
    largest = std::max(largest, dx * dx + dy * dy + dz * dz);
  }
  return std::sqrt(largest);
}

double rootMeanSquareCornerSpeed(const ParticleArray& velocity) {
  const std::size_t corners = velocity.component[0].size();
  if (corners == 0) return 0.0;
  double sum = 0.0;
  for (const auto& values : velocity.component) {
    for (const double value : values) sum += value * value;
  }
  return std::sqrt(sum / static_cast<double>(corners));
}

double topHeight(const ParticleArray& position) {
  if (position.blockCount() == 0) return 0.0;
  double top = -std::numeric_limits<double>::infinity();
  for (std::size_t b = 0; b < position.blockCount(); ++b) {
    const double rise = 0.5 * std::abs(meanEdge(position, b, uprightAxis(position, b)).z());
    top = std::max(top, centre(position, b).z() + rise);
  }
  return top;
}

double topHeightError(const ParticleArray& closed, const ParticleArray& position) {
  return topHeight(position) - topHeight(closed);
}

}  // namespace springtower
