#include "solver/world/stiffness.h"

#include "core/geometry/oriented_box.h"
#include "core/geometry/sweep.h"
#include "core/tuning.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

namespace springtower {

namespace {

struct BlockBounds {
  std::array<double, 3> lower;
  std::array<double, 3> upper;
};

BlockBounds boundsOf(const BlockSpec& block) {
  const Vec3 reach = orientedBox(block.centre, block.orientation, block.dimensions).reach();
  BlockBounds bounds;
  for (std::size_t a = 0; a < 3; ++a) {
    const auto axis = static_cast<Eigen::Index>(a);
    bounds.lower[a] = block.centre[axis] - reach[axis];
    bounds.upper[a] = block.centre[axis] + reach[axis];
  }
  return bounds;
}

double overlapLength(const BlockBounds& a, const BlockBounds& b, std::size_t axis) {
  return std::min(a.upper[axis], b.upper[axis]) - std::max(a.lower[axis], b.lower[axis]);
}

// The supports of each block: the highest blocks below it within its outline, with tops within half a block of the highest such
// top.
std::vector<std::vector<std::size_t>> supportsOf(const std::vector<BlockBounds>& bounds) {
  const std::size_t count = bounds.size();
  std::vector<std::vector<std::size_t>> below(count);
  std::vector<double> lower;
  std::vector<double> upper;
  for (const BlockBounds& box : bounds) {
    lower.push_back(box.lower[0]);
    upper.push_back(box.upper[0]);
  }
  forEachOverlap(lower, upper, 0.0, [&](std::size_t p, std::size_t q) {
    if (overlapLength(bounds[p], bounds[q], 1) <= 0.0) return;
    const bool pIsLower = bounds[p].lower[2] + bounds[p].upper[2] < bounds[q].lower[2] + bounds[q].upper[2];
    below[pIsLower ? q : p].push_back(pIsLower ? p : q);
  });
  for (std::size_t b = 0; b < count; ++b) {
    double top = -1e300;
    for (const std::size_t s : below[b]) top = std::max(top, bounds[s].upper[2]);
    const double height = bounds[b].upper[2] - bounds[b].lower[2];
    std::erase_if(below[b], [&](std::size_t s) { return bounds[s].upper[2] < top - 0.5 * height; });
    std::sort(below[b].begin(), below[b].end());
  }
  return below;
}

// Second moments of the corners of all overlaps of one level about their mean, the lesser of x and y, m2.
struct LevelMoments {
  double points = 0.0;
  std::array<double, 2> first{};
  std::array<double, 2> second{};

  void add(double low, double high, std::size_t axis) {
    first[axis] += 2.0 * (low + high);
    second[axis] += 2.0 * (low * low + high * high);
  }
  [[nodiscard]] double least() const {
    if (points == 0.0) return 0.0;
    return std::min(second[0] - first[0] * first[0] / points, second[1] - first[1] * first[1] / points);
  }
};

// Height difference of the tops of a block's supports, m.
double unevenness(const std::vector<BlockBounds>& bounds, const std::vector<std::size_t>& supports) {
  if (supports.empty()) return 0.0;
  double lowest = 1e300;
  double highest = -1e300;
  for (const std::size_t s : supports) {
    lowest = std::min(lowest, bounds[s].upper[2]);
    highest = std::max(highest, bounds[s].upper[2]);
  }
  return highest - lowest;
}

// Whether one of a block's sides is level.
bool isLevel(const BlockSpec& block) {
  return block.orientation.toRotationMatrix().row(2).cwiseAbs().maxCoeff() > tuning::kLevelCosine;
}

// Height of a block above the highest of its supports, or the floor, if none of its sides is level; otherwise 0.
double askewFall(const Scene& scene, const std::vector<BlockBounds>& bounds, std::size_t b,
                 const std::vector<std::size_t>& supports) {
  if (isLevel(scene.blocks[b])) return 0.0;
  if (supports.empty() && !scene.floor) return 0.0;
  double top = supports.empty() ? 0.0 : -1e300;
  for (const std::size_t s : supports) top = std::max(top, bounds[s].upper[2]);
  return std::max(0.0, bounds[b].lower[2] - top);
}

// Blocks by the height of their middle, the highest first.
std::vector<std::size_t> orderFromTop(const std::vector<BlockBounds>& bounds) {
  const std::size_t count = bounds.size();
  std::vector<std::size_t> fromTop(count);
  std::iota(fromTop.begin(), fromTop.end(), std::size_t{0});
  const auto middle = [&](std::size_t b) { return bounds[b].lower[2] + bounds[b].upper[2]; };
  std::sort(fromTop.begin(), fromTop.end(),
            [&](std::size_t p, std::size_t q) { return middle(p) != middle(q) ? middle(p) > middle(q) : p < q; });
  return fromTop;
}

// Results of the pass that sums loads from the top down.
struct Weighed {
  double tower_n = 0.0;    // weight of all level blocks
  bool anyUneven = false;  // whether any block's supports differ in height
};

Weighed weigh(const Scene& scene, const std::vector<BlockBounds>& bounds, const std::vector<std::vector<std::size_t>>& below,
              const std::vector<std::size_t>& fromTop, LoadEstimate& estimate) {
  Weighed weighed;
  std::vector<double> load(scene.blocks.size(), 0.0);
  // Without gravity nothing loads a contact, yet blocks must be stiff: their weights on Earth are used.
  const double weighing = scene.gravity.magnitude > 0.0 ? scene.gravity.magnitude : kStandardGravity_m_s2;
  for (const std::size_t b : fromTop) {
    const double own = scene.blocks[b].mass * weighing;
    load[b] += own;
    if (isLevel(scene.blocks[b])) weighed.tower_n += own;
    estimate.askewFall_m = std::max(estimate.askewFall_m, askewFall(scene, bounds, b, below[b]));
    const double spread = unevenness(bounds, below[b]);
    const bool uneven = spread > tuning::kUnevenHeight * (bounds[b].upper[2] - bounds[b].lower[2]);
    weighed.anyUneven = weighed.anyUneven || uneven;
    const double supports = std::max(1.0, static_cast<double>(below[b].size()));
    const double shares = uneven ? std::min(supports, 2.0) : supports;
    double& largest = below[b].empty() ? estimate.floorLoad_n : estimate.contactLoad_n;
    largest = std::max(largest, load[b] / shares / tuning::kLoadedPoints);
    estimate.blockLoad_n = std::max(estimate.blockLoad_n, load[b] / tuning::kLoadedPoints);
    // Nothing may rest on this block yet, but an equal block may be put on it.
    estimate.contactLoad_n = std::max(estimate.contactLoad_n, own / tuning::kLoadedPoints);
    estimate.floorLoad_n = std::max(estimate.floorLoad_n, own / tuning::kLoadedPoints);
    for (const std::size_t s : below[b]) load[s] += load[b] / supports;
  }
  return weighed;
}

// The level of each block above the floor, by the longest path down; returns the number of levels.
std::size_t findLevels(const std::vector<std::vector<std::size_t>>& below, const std::vector<std::size_t>& fromTop,
                       std::vector<std::size_t>& level) {
  level.assign(fromTop.size(), 0);
  std::size_t levels = 0;
  for (auto b = fromTop.rbegin(); b != fromTop.rend(); ++b) {
    for (const std::size_t s : below[*b]) level[*b] = std::max(level[*b], level[s] + 1);
    levels = std::max(levels, level[*b] + 1);
  }
  return levels;
}

// Extent of the scene, and the joints between its level blocks, level by level.
struct Joints {
  std::vector<LevelMoments> moments;
  std::array<double, 3> lower{1e300, 1e300, 1e300};  // m, of all blocks
  std::array<double, 3> upper{-1e300, -1e300, -1e300};
  double foot = 1e300;  // m, of the level ones
  double top = -1e300;
};

Joints findJoints(const Scene& scene, const std::vector<BlockBounds>& bounds, const std::vector<std::vector<std::size_t>>& below,
                  const std::vector<std::size_t>& level, std::size_t levels) {
  Joints joints;
  joints.moments.resize(levels);
  for (std::size_t b = 0; b < bounds.size(); ++b) {
    for (std::size_t a = 0; a < 3; ++a) {
      joints.lower[a] = std::min(joints.lower[a], bounds[b].lower[a]);
      joints.upper[a] = std::max(joints.upper[a], bounds[b].upper[a]);
    }
    if (!isLevel(scene.blocks[b])) continue;  // no joint of a tower
    joints.foot = std::min(joints.foot, bounds[b].lower[2]);
    joints.top = std::max(joints.top, bounds[b].upper[2]);
    LevelMoments& here = joints.moments[level[b]];
    const auto addOverlap = [&](const BlockBounds& support) {
      here.points += tuning::kPointsPerOverlap;
      for (std::size_t a = 0; a < 2; ++a) {
        here.add(std::max(bounds[b].lower[a], support.lower[a]), std::min(bounds[b].upper[a], support.upper[a]), a);
      }
    };
    for (const std::size_t s : below[b]) addOverlap(bounds[s]);
    if (below[b].empty()) addOverlap(bounds[b]);
  }
  return joints;
}

// Contact stiffness at which the levels do not buckle, N/m.
double swayStiffness(const Joints& found, double towerWeight) {
  double compliance = 0.0;
  std::size_t joints = 0;
  for (const LevelMoments& here : found.moments) {
    if (here.points == 0.0) continue;
    compliance += 1.0 / std::max(here.least(), 1e-12);
    ++joints;
  }
  const auto n = static_cast<double>(joints);
  // Weight per level w and level height h: a chain of n joints of stiffness S buckles near w h n^3 = 7.837 S.
  const double jointNeeded = (towerWeight / n) * ((found.top - found.foot) / n) * n * n * n / tuning::kBucklingParameter;
  return joints < 2 ? 0.0 : tuning::kBucklingSafetyFactor * jointNeeded * (compliance / n) / tuning::kSeriesStiffnessShare;
}

}  // namespace

LoadEstimate estimateLoads(const Scene& scene) {
  const std::size_t count = scene.blocks.size();
  std::vector<BlockBounds> bounds(count);
  for (std::size_t b = 0; b < count; ++b) bounds[b] = boundsOf(scene.blocks[b]);
  const auto below = supportsOf(bounds);
  const std::vector<std::size_t> fromTop = orderFromTop(bounds);
  LoadEstimate estimate;
  const Weighed weighed = weigh(scene, bounds, below, fromTop, estimate);
  std::vector<std::size_t> level;
  const std::size_t levels = findLevels(below, fromTop, level);
  estimate.layers = static_cast<int>(levels);
  if (count == 0) return estimate;
  const Joints joints = findJoints(scene, bounds, below, level, levels);
  estimate.swayStiffness_n_m = swayStiffness(joints, weighed.tower_n);

  const double lean = std::abs(scene.gravity.tilt_deg) + std::abs(scene.gravity.sway_deg);
  const double narrow = 0.5 * std::min(joints.upper[0] - joints.lower[0], joints.upper[1] - joints.lower[1]);
  const double lever = std::min(
      1.0, 0.5 * (joints.upper[2] - joints.lower[2]) * std::tan(std::min(lean, 45.0) * M_PI / 180.0) / std::max(narrow, 1e-12));
  const double concentration = (1.0 + lever) * (weighed.anyUneven ? tuning::kUnevenLoad : 1.0);
  estimate.contactLoad_n *= concentration;
  estimate.floorLoad_n *= concentration;
  estimate.blockLoad_n *= concentration;
  return estimate;
}

Stiffness stiffnessForTolerance(const LoadEstimate& loads, double tolerance_m) {
  const auto stiffness = [&](double load) { return std::max(load / tolerance_m, loads.swayStiffness_n_m); };
  return {stiffness(loads.contactLoad_n), stiffness(loads.floorLoad_n), stiffness(loads.blockLoad_n)};
}

double stableStep(Method method, double spectralRadius, double dampingTime_s, double margin) {
  const double limit = 4.0 * margin * margin / spectralRadius;
  const double step = std::sqrt(dampingTime_s * dampingTime_s + limit) - dampingTime_s;
  return method == Method::midpoint ? std::min(step, margin * std::cbrt(4.0 * dampingTime_s / spectralRadius)) : step;
}

double stableSpectralRadius(Method method, double step_s, double dampingTime_s, double margin) {
  const double radius = 4.0 * margin * margin / (step_s * (step_s + 2.0 * dampingTime_s));
  const double step = step_s / margin;
  return method == Method::midpoint ? std::min(radius, 4.0 * dampingTime_s / (step * step * step)) : radius;
}

double impactDepth_m(const Settings& settings, double tolerance_m, double blockHeight_m) {
  const double usual_m = kBlockTolerance_m * (blockHeight_m / kBlockHeight_m);
  return settings.impactDepth * std::max(tolerance_m, usual_m);
}

}  // namespace springtower
