#include "solver/world/load_estimate.h"

#include "broadphase/islands.h"
#include "core/elementary.h"
#include "core/geometry/oriented_box.h"
#include "core/geometry/polygon.h"
#include "core/geometry/sweep.h"
#include "core/tuning.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

namespace springtower {

namespace {

// A block as seen from above, and its vertical extent.
struct Footprint {
  OrientedBox box;
  Polygon outline;
  double area_m2;
  double lower_m;
  double upper_m;
};

Footprint footprintOf(const BlockSpec& block) {
  const OrientedBox box = orientedBox(block.centre, block.orientation, block.dimensions);
  Polygon corners;
  for (unsigned c = 0; c < 8; ++c) corners.push_back(box.corner(c).head<2>());
  Polygon outline = convexHull(std::move(corners));
  const double area_m2 = areaMoments(outline).area_m2;
  const double reach = box.reachAlong(Vec3::UnitZ());
  return {box, std::move(outline), area_m2, block.centre.z() - reach, block.centre.z() + reach};
}

// The heights between which the vertical line through a place runs inside a block, m; empty (first > second) where it misses it.
struct HeightSpan {
  double lower = -1e300;
  double upper = 1e300;
};

HeightSpan spanThrough(const OrientedBox& box, const Eigen::Vector2d& place) {
  HeightSpan span;
  const Vec3 arm(place.x() - box.centre.x(), place.y() - box.centre.y(), 0.0);
  for (Eigen::Index a = 0; a < 3; ++a) {
    const double slope = box.axes(2, a);
    if (slope == 0.0) continue;
    const double along = box.axes.col(a).dot(arm);
    const double first = (-box.half[a] - along) / slope;
    const double second = (box.half[a] - along) / slope;
    span.lower = std::max(span.lower, box.centre.z() + std::min(first, second));
    span.upper = std::min(span.upper, box.centre.z() + std::max(first, second));
  }
  return span;
}

// A block under another: what their outlines have in common, and the heights at which the lower one ends there and the upper one
// begins.
struct Support {
  std::size_t block;
  AreaMoments overlap;
  double top_m;
  double bottom_m;
};

using Supports = std::vector<std::vector<Support>>;

// Adds the lower one of two blocks to the supports of the upper one, if their outlines overlap and they do not stand beside one
// another. A fixed block needs none.
void addSupport(const Scene& scene, const std::vector<Footprint>& footprints, std::size_t p, std::size_t q, Supports& below) {
  if (scene.blocks[p].fixed && scene.blocks[q].fixed) return;
  const AreaMoments overlap = areaMoments(overlapOf(footprints[p].outline, footprints[q].outline));
  if (overlap.area_m2 <= tuning::kMinOverlap * std::min(footprints[p].area_m2, footprints[q].area_m2)) return;
  const HeightSpan ofP = spanThrough(footprints[p].box, overlap.centroid);
  const HeightSpan ofQ = spanThrough(footprints[q].box, overlap.centroid);
  const bool pIsLower = ofP.lower + ofP.upper < ofQ.lower + ofQ.upper;
  const HeightSpan& lower = pIsLower ? ofP : ofQ;
  const HeightSpan& upper = pIsLower ? ofQ : ofP;
  if (lower.upper - upper.lower > 0.5 * std::min(lower.upper - lower.lower, upper.upper - upper.lower)) return;
  if (scene.blocks[pIsLower ? q : p].fixed) return;
  below[pIsLower ? q : p].push_back({pIsLower ? p : q, overlap, lower.upper, upper.lower});
}

// Extents of the blocks along an axis, m.
struct Extents {
  std::vector<double> lower;
  std::vector<double> upper;
};

Extents extentsAlong(const std::vector<Footprint>& footprints, Eigen::Index axis) {
  Extents extents;
  for (const Footprint& footprint : footprints) {
    const double reach = footprint.box.reachAlong(Vec3::Unit(axis));
    extents.lower.push_back(footprint.box.centre[axis] - reach);
    extents.upper.push_back(footprint.box.centre[axis] + reach);
  }
  return extents;
}

// The highest top among a block's supports, m.
double highestTop(const std::vector<Support>& supports) {
  double top = -1e300;
  for (const Support& support : supports) top = std::max(top, support.top_m);
  return top;
}

// Calls visit(p, q) for all pairs of blocks, p the higher one, except that it leaves out blocks too low to be among the supports
// that count. In a tower all outlines overlap.
template <class Visit>
void forEachBelow(const std::vector<Footprint>& footprints, const Supports& below, const Visit& visit) {
  std::vector<std::size_t> fromTop(footprints.size());
  std::iota(fromTop.begin(), fromTop.end(), std::size_t{0});
  std::stable_sort(fromTop.begin(), fromTop.end(),
                   [&](std::size_t p, std::size_t q) { return footprints[p].upper_m > footprints[q].upper_m; });
  for (std::size_t i = 0; i < fromTop.size(); ++i) {
    const std::size_t p = fromTop[i];
    const double height = footprints[p].upper_m - footprints[p].lower_m;
    for (std::size_t j = i + 1; j < fromTop.size(); ++j) {
      if (footprints[fromTop[j]].upper_m < highestTop(below[p]) - 0.5 * height) break;
      visit(p, fromTop[j]);
    }
  }
}

// The supports of each block: the highest blocks below it within its outline, with tops within half a block of the highest such
// top.
Supports supportsOf(const Scene& scene, const std::vector<Footprint>& footprints) {
  Supports below(footprints.size());
  const auto placeOf = [&](std::size_t b) { return footprints[b].box.centre; };
  const auto levelPlaceOf = [&](std::size_t b) { return Vec3(placeOf(b).x(), placeOf(b).y(), 0.0); };
  const auto axis = std::min<Eigen::Index>(1, widestAxis(footprints.size(), levelPlaceOf));
  const Extents along = extentsAlong(footprints, axis);
  const Extents across = extentsAlong(footprints, 1 - axis);
  const auto meet = [](const Extents& extents, std::size_t p, std::size_t q) {
    return extents.lower[p] < extents.upper[q] && extents.lower[q] < extents.upper[p];
  };
  const auto visit = [&](std::size_t p, std::size_t q) {
    if (meet(across, p, q)) addSupport(scene, footprints, p, q, below);
  };
  if (widestAxis(footprints.size(), placeOf) == 2) {
    forEachBelow(footprints, below, [&](std::size_t p, std::size_t q) {
      if (!meet(along, p, q)) return;
      const bool isFirst = along.lower[p] != along.lower[q] ? along.lower[p] < along.lower[q] : p < q;
      isFirst ? visit(p, q) : visit(q, p);  // the order of the sweep, so that rounding is the same either way
    });
  } else {
    forEachOverlap(along.lower, along.upper, 0.0, visit);
  }
  for (std::size_t b = 0; b < footprints.size(); ++b) {
    const double top = highestTop(below[b]);
    const double height = footprints[b].upper_m - footprints[b].lower_m;
    std::erase_if(below[b], [&](const Support& support) { return support.top_m < top - 0.5 * height; });
    std::sort(below[b].begin(), below[b].end(), [](const Support& s, const Support& t) { return s.block < t.block; });
  }
  return below;
}

// Height difference of the tops of a block's supports, m. A block that has compressed some, as at rest, may lie on them at a
// slope of its own: then it is the largest gap between it and one of them.
double unevenness(const std::vector<Support>& supports, double height_m) {
  if (supports.empty()) return 0.0;
  double lowest_m = 1e300;
  double highest_m = -1e300;
  double gap_m = 0.0;
  bool presses = false;
  for (const Support& support : supports) {
    lowest_m = std::min(lowest_m, support.top_m);
    highest_m = std::max(highest_m, support.top_m);
    gap_m = std::max(gap_m, support.bottom_m - support.top_m);
    presses = presses || support.top_m - support.bottom_m > tuning::kFirstContactError * height_m;
  }
  return presses ? gap_m : highest_m - lowest_m;
}

// Whether one of a block's sides is level.
bool isLevel(const BlockSpec& block) {
  return block.orientation.toRotationMatrix().row(2).cwiseAbs().maxCoeff() > tuning::kLevelCosine;
}

// Height of a block above the highest of its supports, or the floor, if none of its sides is level; otherwise 0.
double askewFall(const Scene& scene, const Footprint& footprint, const BlockSpec& block, const std::vector<Support>& supports) {
  if (block.fixed || isLevel(block)) return 0.0;
  if (supports.empty() && !scene.floor) return 0.0;
  double top = supports.empty() ? 0.0 : -1e300;
  for (const Support& support : supports) top = std::max(top, support.top_m);
  return std::max(0.0, footprint.lower_m - top);
}

// The level of each block above the floor, by the longest path down. Supports first, depth first from the highest block on; a
// support that leads back to a block on the path, as of blocks that lean on one another, does not count.
std::vector<std::size_t> levelsOf(const Scene& scene, const Supports& below) {
  std::vector<std::size_t> fromTop(below.size());
  std::iota(fromTop.begin(), fromTop.end(), std::size_t{0});
  std::stable_sort(fromTop.begin(), fromTop.end(),
                   [&](std::size_t p, std::size_t q) { return scene.blocks[p].centre.z() > scene.blocks[q].centre.z(); });
  std::vector<std::size_t> level(below.size(), 0);
  std::vector<std::size_t> visited(below.size(), 0);  // next support to follow, plus 1 once all are followed; 0: not reached
  std::vector<std::size_t> path;
  for (const std::size_t first : fromTop) {
    if (visited[first] == 0) path.push_back(first);
    while (!path.empty()) {
      const std::size_t b = path.back();
      if (visited[b] > below[b].size()) {
        for (const Support& support : below[b]) {
          if (visited[support.block] > below[support.block].size()) level[b] = std::max(level[b], level[support.block] + 1);
        }
        path.pop_back();
        continue;
      }
      const std::size_t next = visited[b]++;
      if (next < below[b].size() && visited[below[b][next].block] == 0) path.push_back(below[b][next].block);
    }
  }
  return level;
}

// Blocks by level, then by the height of their middle, the highest first: every block before its supports.
std::vector<std::size_t> orderFromTop(const Scene& scene, const std::vector<std::size_t>& level) {
  std::vector<std::size_t> fromTop(scene.blocks.size());
  std::iota(fromTop.begin(), fromTop.end(), std::size_t{0});
  std::stable_sort(fromTop.begin(), fromTop.end(), [&](std::size_t p, std::size_t q) {
    return level[p] != level[q] ? level[p] > level[q] : scene.blocks[p].centre.z() > scene.blocks[q].centre.z();
  });
  return fromTop;
}

// Finds the stacks: blocks that supports join.
void findStacks(const Supports& below, LoadEstimate& estimate) {
  std::vector<BlockPair> edges;
  for (std::size_t b = 0; b < below.size(); ++b) {
    for (const Support& support : below[b])
      edges.push_back({static_cast<std::int32_t>(support.block), static_cast<std::int32_t>(b)});
  }
  Islands stacks;
  updateIslands(stacks, edges, std::vector<std::uint8_t>(below.size(), 0));
  estimate.stackOf = std::move(stacks.islandOf);
  estimate.stacks.resize(stacks.count());
}

// Sums of a stack that its load depends on beside those of its blocks.
struct StackSums {
  double level_n = 0.0;    // N, weight of its level blocks
  bool anyUneven = false;  // whether any block's supports differ in height
  Polygon corners;         // m, of the outlines
  double lower_m = 1e300;
  double upper_m = -1e300;
  double foot_m = 1e300;  // m, of the level ones
  double top_m = -1e300;
  std::size_t levels = 0;
  std::size_t blocks = 0;
};

// Sums loads from the top down.
void weigh(const Scene& scene, const std::vector<Footprint>& footprints, const Supports& below,
           const std::vector<std::size_t>& fromTop, LoadEstimate& estimate, std::vector<StackSums>& sums) {
  std::vector<double>& load = estimate.load_n;
  load.assign(scene.blocks.size(), 0.0);
  // Without gravity nothing loads a contact, yet blocks must be stiff: their weights on Earth are used.
  const double weighing = scene.gravity.magnitude > 0.0 ? scene.gravity.magnitude : kStandardGravity_m_s2;
  for (const std::size_t b : fromTop) {
    const auto stack = static_cast<std::size_t>(estimate.stackOf[b]);
    const double own = scene.blocks[b].mass * weighing;
    load[b] += own;
    estimate.stacks[stack].mean_n += own;
    ++sums[stack].blocks;
    if (isLevel(scene.blocks[b])) sums[stack].level_n += own;
    const double height_m = footprints[b].upper_m - footprints[b].lower_m;
    const bool uneven = unevenness(below[b], height_m) > tuning::kUnevenHeight * height_m;
    sums[stack].anyUneven = sums[stack].anyUneven || uneven;
    double area_m2 = 0.0;
    double largest_m2 = 0.0;
    for (const Support& support : below[b]) {
      area_m2 += support.overlap.area_m2;
      largest_m2 = std::max(largest_m2, support.overlap.area_m2);
    }
    const double even = below[b].empty() ? 1.0 : largest_m2 / area_m2;
    const double share = uneven ? std::max(even, 0.5) : even;  // of uneven supports a block rests on two
    StackLoad& of = estimate.stacks[stack];
    double& largest = below[b].empty() ? of.floor_n : of.contact_n;
    largest = std::max(largest, load[b] * share / tuning::kLoadedPoints);
    of.edge_n = std::max(of.edge_n, load[b] / tuning::kLoadedPoints);
    // Nothing may rest on this block yet, but an equal block may be put on it.
    of.contact_n = std::max(of.contact_n, own / tuning::kLoadedPoints);
    of.floor_n = std::max(of.floor_n, own / tuning::kLoadedPoints);
    for (const Support& support : below[b]) load[support.block] += load[b] * (support.overlap.area_m2 / area_m2);
  }
}

// Moments of the contact points of one level of a stack: four points an overlap, at the corners of a rectangle of its area
// moments, and fewer where a block's other overlaps are larger.
struct LevelMoments {
  double points = 0.0;
  Eigen::Vector2d first = Eigen::Vector2d::Zero();
  Eigen::Matrix2d second = Eigen::Matrix2d::Zero();

  // `from`: any place nearby, so that scenes far from the origin lose no digits.
  void add(const AreaMoments& overlap, double share, const Eigen::Vector2d& from) {
    const double weight = share * tuning::kPointsPerOverlap;
    const Eigen::Vector2d place = overlap.centroid - from;
    points += weight;
    first += weight * place;
    // The corners of a rectangle have three times its second moment per area.
    second += weight * (3.0 * overlap.secondPerArea + place * place.transpose());
  }
  // Least second moment about the mean over all directions, m2.
  [[nodiscard]] double least() const {
    const Eigen::Matrix2d central = second - first * first.transpose() / points;
    const double middle = 0.5 * (central(0, 0) + central(1, 1));
    const double half = 0.5 * (central(0, 0) - central(1, 1));
    return middle - std::sqrt(half * half + central(0, 1) * central(1, 0));
  }
};

// Extents of the stacks, and the moments of their joints between level blocks, level by level: [stack][level].
std::vector<std::vector<LevelMoments>> findJoints(const Scene& scene, const std::vector<Footprint>& footprints,
                                                  const Supports& below, const std::vector<std::size_t>& level,
                                                  const LoadEstimate& estimate, std::vector<StackSums>& sums) {
  std::vector<std::vector<LevelMoments>> joints;
  joints.reserve(sums.size());
  for (const StackSums& of : sums) joints.emplace_back(of.levels);
  for (std::size_t b = 0; b < footprints.size(); ++b) {
    const auto stack = static_cast<std::size_t>(estimate.stackOf[b]);
    const Footprint& footprint = footprints[b];
    StackSums& of = sums[stack];
    of.corners.insert(of.corners.end(), footprint.outline.begin(), footprint.outline.end());
    of.lower_m = std::min(of.lower_m, footprint.lower_m);
    of.upper_m = std::max(of.upper_m, footprint.upper_m);
    if (!isLevel(scene.blocks[b])) continue;  // no joint of a tower
    of.foot_m = std::min(of.foot_m, footprint.lower_m);
    of.top_m = std::max(of.top_m, footprint.upper_m);
    double largest_m2 = 0.0;
    for (const Support& support : below[b]) largest_m2 = std::max(largest_m2, support.overlap.area_m2);
    LevelMoments& here = joints[stack][level[b]];
    for (const Support& support : below[b]) here.add(support.overlap, support.overlap.area_m2 / largest_m2, of.corners.front());
    if (below[b].empty()) here.add(areaMoments(footprint.outline), 1.0, of.corners.front());
  }
  return joints;
}

// Contact stiffness at which the levels of a stack do not buckle, N/m.
double swayStiffness(const std::vector<LevelMoments>& levels, const StackSums& of) {
  double compliance = 0.0;
  std::size_t joints = 0;
  for (const LevelMoments& here : levels) {
    if (here.points == 0.0) continue;
    compliance += 1.0 / std::max(here.least(), 1e-12);
    ++joints;
  }
  if (joints < 2) return 0.0;
  const auto n = static_cast<double>(joints);
  // Weight per level w and level height h: a chain of n joints of stiffness S buckles near w h n^3 = 7.837 S.
  const double jointNeeded = (of.level_n / n) * ((of.top_m - of.foot_m) / n) * n * n * n / tuning::kBucklingParameter;
  return tuning::kBucklingSafetyFactor * jointNeeded * (compliance / n) / tuning::kSeriesStiffnessShare;
}

// By how much more than their even share the most loaded points of a stack bear, under tilted gravity and on uneven heights.
double concentrationOf(const Gravity& gravity, const StackSums& of) {
  const double lean_deg = std::min(std::abs(gravity.tilt_deg) + std::abs(gravity.sway_deg), 45.0);
  const double narrow_m = 0.5 * leastWidth(convexHull(of.corners));
  const double lever_m = 0.5 * (of.upper_m - of.lower_m) * elementary::tan(lean_deg * std::numbers::pi / 180.0);
  const double lever = std::min(1.0, lever_m / std::max(narrow_m, 1e-12));
  return (1.0 + lever) * (of.anyUneven ? tuning::kUnevenLoad : 1.0);
}

}  // namespace

LoadEstimate estimateLoads(const Scene& scene) {
  const std::size_t count = scene.blocks.size();
  LoadEstimate estimate;
  if (count == 0) return estimate;
  std::vector<Footprint> footprints;
  footprints.reserve(count);
  for (const BlockSpec& block : scene.blocks) footprints.push_back(footprintOf(block));
  Supports below = supportsOf(scene, footprints);
  for (std::size_t b = 0; b < count; ++b) {
    estimate.askewFall_m = std::max(estimate.askewFall_m, askewFall(scene, footprints[b], scene.blocks[b], below[b]));
    // What lies on fixed blocks lies on ground, and they join no stacks.
    std::erase_if(below[b], [&](const Support& support) { return scene.blocks[support.block].fixed; });
  }
  findStacks(below, estimate);
  std::vector<StackSums> sums(estimate.stacks.size());
  const std::vector<std::size_t> level = levelsOf(scene, below);
  for (std::size_t b = 0; b < count; ++b) {
    std::size_t& levels = sums[static_cast<std::size_t>(estimate.stackOf[b])].levels;
    levels = std::max(levels, level[b] + 1);
    estimate.layers = std::max(estimate.layers, static_cast<int>(level[b]) + 1);
  }
  weigh(scene, footprints, below, orderFromTop(scene, level), estimate, sums);
  const auto joints = findJoints(scene, footprints, below, level, estimate, sums);
  double heaviest_n = 0.0;
  for (const BlockSpec& block : scene.blocks) {
    if (!block.fixed) heaviest_n = std::max(heaviest_n, block.mass * scene.gravity.magnitude / tuning::kLoadedPoints);
  }
  for (std::size_t s = 0; s < sums.size(); ++s) {
    StackLoad& of = estimate.stacks[s];
    of.mean_n /= static_cast<double>(std::max<std::size_t>(1, sums[s].blocks));
    of.sway_n_m = swayStiffness(joints[s], sums[s]);
    const double concentration = concentrationOf(scene.gravity, sums[s]);
    of.contact_n *= concentration;
    of.floor_n = std::max(of.floor_n, heaviest_n) * concentration;
    of.edge_n = std::max(of.edge_n, heaviest_n) * concentration;
  }
  for (std::size_t b = 0; b < count; ++b) {
    if (scene.blocks[b].fixed) estimate.stacks[static_cast<std::size_t>(estimate.stackOf[b])] = {};
  }
  return estimate;
}

}  // namespace springtower
