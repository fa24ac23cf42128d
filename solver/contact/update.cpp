#include "solver/contact/update.h"

#include "core/error.h"
#include "core/lanes.h"
#include "core/tuning.h"
#include "solver/block/shape_change.h"
#include "solver/contact/create.h"
#include "solver/world/checkpoint.h"
#include "solver/world/driven_blocks.h"
#include "solver/world/over_island.h"
#include "solver/world/stage_clock.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>

namespace springtower {

namespace {

// Motion of a block in a step.
struct BlockTravel {
  double path;    // m, of its fastest corner
  double spread;  // m2, squared displacements of the corners relative to their mean, summed; no less than the change of shape
};

SPRINGTOWER_INLINE BlockTravel blockTravel(const ParticleArray& now, const ParticleArray& before, std::size_t b) {
  Lanes squared[2] = {};
  Lanes spread = {};
  for (std::size_t a = 0; a < 3; ++a) {
    Lanes moved[2];
    for (std::size_t half = 0; half < 2; ++half) {
      Lanes from;
      load(now.values(a, b) + 4 * half, moved[half]);
      load(before.values(a, b) + 4 * half, from);
      moved[half] -= from;
      squared[half] += moved[half] * moved[half];
    }
    const double mean = sum(moved[0] + moved[1]) / static_cast<double>(kCorners);
    for (const Lanes& corners : moved) spread += (corners - mean) * (corners - mean);
  }
  const Lanes most = squared[0] > squared[1] ? squared[0] : squared[1];
  return {std::sqrt(std::max(std::max(most[0], most[1]), std::max(most[2], most[3]))), sum(spread)};
}

// A path longer than the margin of the box does not necessarily lead out of it.
bool isInSweptBox(const IslandStep& step, std::size_t block) {
  const SweptBoxes& boxes = step.engine.memo.boxes;
  for (std::size_t a = 0; a < 3; ++a) {
    const double* x = step.simulation.state.position.values(a, block);
    const auto [least, most] = std::minmax_element(x, x + kCorners);
    if (*least < boxes.lower[a][block] || *most > boxes.upper[a][block]) return false;
  }
  return true;
}

// What the paths of a step have led to.
struct Paths {
  std::int32_t diverged = std::numeric_limits<std::int32_t>::max();  // the first block that has diverged
  bool inside = true;                                                // all blocks are in their swept boxes
  bool asAssumed = true;  // none has a longer path than the list of active pairs assumes
};

// Adds the path of each block's fastest corner. A block of springs has diverged when its shape changes by half its least side in
// one step, and every block has when it is faster than tuning::kMaxSpeed, as larger swept boxes would be tried without end. A
// thin block that turns spreads its corners by more than that without any change of shape, which is looked at only then.
// Conditions are written so that NaN, which fails every comparison, counts as diverged.
SPRINGTOWER_KERNEL
Paths addPathsOf(IslandStep& step, std::span<const std::int32_t> blocks) {
  Paths paths;
  const double farthest_m = tuning::kMaxSpeed * step.drift_s;
  for (const std::int32_t block : blocks) {
    const auto b = static_cast<std::size_t>(block);
    const ParticleArray& now = step.simulation.state.position;
    const auto [path, spread] = blockTravel(now, step.engine.memo.previous, b);
    const double most = tuning::kMaxDeformationPerStep * step.simulation.model.dimensions[b].minCoeff();
    const double limit = step.pointKind == PointKind::penalty ? static_cast<double>(kCorners) * most * most
                                                              : std::numeric_limits<double>::infinity();
    const bool keepsShape = spread < limit || shapeChange(now, step.engine.memo.previous, b) < limit;
    if (!(keepsShape && path < farthest_m)) paths.diverged = std::min(paths.diverged, block);
    BlockHistory& history = step.engine.memo.blockHistory[b];
    history.travel += path;
    step.engine.scratch.path[b] = path;
    paths.asAssumed = paths.asAssumed && !(path > step.engine.scratch.assumedPath[b]);
    if (history.travel - step.engine.memo.travelAtSweep[b] > step.engine.scratch.reach[b])
      paths.inside = paths.inside && isInSweptBox(step, b);
  }
  return paths;
}

Paths addPaths(IslandStep& step) {
  return mergeRanges(
      step.blocks.size(), tuning::kBlockGrain, isWide(step), Paths{},
      [&](std::size_t first, std::size_t last) { return addPathsOf(step, step.blocks.subspan(first, last - first)); },
      [](const Paths& a, const Paths& b) {
        return Paths{std::min(a.diverged, b.diverged), a.inside && b.inside, a.asAssumed && b.asAssumed};
      });
}

}  // namespace

bool addTravel(IslandStep& step) {
  const Paths paths = addPaths(step);
  if (!paths.asAssumed) step.activeListSteps = 0;
  const std::int32_t diverged = paths.diverged;
  if (diverged == Paths{}.diverged) return paths.inside;
  const ParticleArray& now = step.simulation.state.position;
  const auto block = static_cast<std::size_t>(diverged);
  const double path = blockTravel(now, step.engine.memo.previous, block).path;
  const double change = shapeChange(now, step.engine.memo.previous, block);
  const double time = step.time_s + step.drift_s;
  std::string cause = "its positions are no longer finite";
  if (std::isfinite(change) && path >= tuning::kMaxSpeed * step.drift_s) {
    cause = fmt::format("it moved by {:.3g} m in one step of {:.3g} s", path, step.drift_s);
  } else if (std::isfinite(change)) {
    cause = fmt::format("its corners moved apart by {:.3g} m in one step of {:.3g} s",
                        std::sqrt(change / static_cast<double>(kCorners)), step.drift_s);
  }
  throw DivergenceError(fmt::format("block {} diverged at {:.6f} s: {}", diverged, time, cause), diverged, time);
}

namespace {

// Lanes beyond the last point are zero.
SPRINGTOWER_INLINE int nonZeros(const FourValues& values) {
  return (values[0] != 0.0 ? 1 : 0) + (values[1] != 0.0 ? 1 : 0) + (values[2] != 0.0 ? 1 : 0) + (values[3] != 0.0 ? 1 : 0);
}

bool slides(const ContactView& manifold) {
  for (std::size_t r = 0; r < rowsFor(manifold.count); ++r) {
    if (nonZeros(manifold.points[r]->penalty.slipRatio) > 0) return true;
  }
  return false;
}

// Whether blocks touch only at a corner or along a line, so that one may roll on the other.
bool rolls(const ContactView& manifold) {
  int touching = 0;
  for (std::size_t r = 0; r < rowsFor(manifold.count); ++r) touching += nonZeros(manifold.points[r]->penalty.touching);
  return touching == 1 || touching == 2;
}

// Travel after which a pair's manifold is refreshed, m.
double refreshTravelOf(const ContactView& manifold, const RefreshTravel& travel) {
  if (slides(manifold)) return travel.sliding_m;
  return rolls(manifold) ? travel.rolling_m : travel.resting_m;
}

// How wide a face manifold is where it is narrowest, m: twice the least standard deviation of its points, the shorter side of a
// rectangle. 0 of points on a line, and of an edge manifold.
double leastWidthOf(const Simulation& simulation, const ContactView& manifold) {
  if (manifold.phase != PairPhase::face) return 0.0;
  const FaceAxes& face = kFaceAxes[static_cast<std::size_t>(manifold.incidentFace)];
  const Vec3& lengths = simulation.model.dimensions[static_cast<std::size_t>(manifold.upper)];
  const double lengthU = lengths[static_cast<Eigen::Index>(face.u)];
  const double lengthV = lengths[static_cast<Eigen::Index>(face.v)];
  double u = 0.0, v = 0.0, uu = 0.0, uv = 0.0, vv = 0.0;  // sums, m and m2
  for (std::int32_t i = 0; i < manifold.count; ++i) {
    const auto point = static_cast<std::size_t>(i);
    const PlaceRow& row = *manifold.place[rowOf(point)];
    const double atU = lengthU * row.u[laneOf(point)];
    const double atV = lengthV * row.v[laneOf(point)];
    u += atU;
    v += atV;
    uu += atU * atU;
    uv += atU * atV;
    vv += atV * atV;
  }
  const double count = manifold.count;
  const double varianceU = uu / count - u * u / (count * count);
  const double varianceV = vv / count - v * v / (count * count);
  const double covariance = uv / count - u * v / (count * count);
  const double apart = varianceU - varianceV;
  const double least = 0.5 * (varianceU + varianceV - std::sqrt(apart * apart + 4.0 * covariance * covariance));
  return 2.0 * std::sqrt(std::max(0.0, least));
}

constexpr double kNever = std::numeric_limits<double>::infinity();

// Relative pose of a pair: b's centre and sides along a's edges; if b is the floor, a's height and sides in world axes, as the
// floor is everywhere the same. m; as the frames were computed last, in explicit steps where the step began.
RelativePose poseOf(const IslandStep& step, const BlockPair& pair) {
  const auto a = static_cast<std::size_t>(pair.a);
  const BlockFrame& frame = step.engine.memo.frames[a];
  RelativePose pose;
  if (pair.b < 0) {
    for (std::size_t k = 0; k < 3; ++k) {
      pose[k] = k < 2 ? 0.0F : static_cast<float>(frame.place.centre[k]);
      for (std::size_t i = 0; i < 3; ++i) pose[3 + 3 * i + k] = static_cast<float>(frame.place.side[i][k]);
    }
    return pose;
  }
  const AffineField& other = step.engine.memo.frames[static_cast<std::size_t>(pair.b)].place;
  const Vec3& lengths = step.simulation.model.dimensions[a];
  for (std::size_t k = 0; k < 3; ++k) {
    const double length = lengths[static_cast<Eigen::Index>(k)];
    const auto along = [&](double x, double y, double z) {
      return static_cast<float>(length * (frame.dual[k][0] * x + frame.dual[k][1] * y + frame.dual[k][2] * z));
    };
    const std::array<double, 3>& from = frame.place.centre;
    pose[k] = along(other.centre[0] - from[0], other.centre[1] - from[1], other.centre[2] - from[2]);
    for (std::size_t i = 0; i < 3; ++i) pose[3 + 3 * i + k] = along(other.side[i][0], other.side[i][1], other.side[i][2]);
  }
  return pose;
}

// Upper bound of the relative displacement of two blocks' points between two poses, m.
double movedBetween(const RelativePose& before, const RelativePose& now) {
  double moved = 0.0;
  for (std::size_t i = 0; i < 4; ++i) {
    double squared = 0.0;
    for (std::size_t k = 3 * i; k < 3 * i + 3; ++k) {
      const double change = static_cast<double>(now[k]) - static_cast<double>(before[k]);
      squared += change * change;
    }
    moved += (i == 0 ? 1.0 : 0.5) * std::sqrt(squared);
  }
  return moved;
}

// Whether the relative pose of a pair has hardly changed since its manifold was refreshed: blocks that sway or topple together
// have a long travel without that. Points that are springs hold their outline to this; sequential impulses list points anew.
bool isPoseUnchanged(IslandStep& step, std::size_t at, const RelativePose& pose, double travel, double most) {
  PairTable& pairs = step.engine.pairs;
  const double share = step.pointKind == PointKind::penalty ? tuning::kUnchangedSpringPoseShare : tuning::kUnchangedPoseShare;
  const double moved = movedBetween(step.engine.contacts.pose(pairs.contact[at]), pose);
  if (!(moved < share * most)) return false;
  pairs.travelAtCheck[at] = travel - moved;
  return true;
}

// Whether a pair may need a check: its travel has used up the clearance, or the least travel after which any manifold is
// refreshed.
SPRINGTOWER_INLINE bool isDue(const Engine& engine, std::size_t at, double leastRefresh) {
  const double used = travelOf(engine, at) - engine.pairs.travelAtCheck[at];
  return engine.pairs.touches(at) ? used > leastRefresh : !(used < engine.pairs.clearance[at]);
}

// Whether points of the pair have been listed for a rigid step, so that it needs no test of its motion.
SPRINGTOWER_INLINE bool isCovered(const IslandStep& step, std::size_t at) {
  return step.pointKind == PointKind::impulse && step.engine.scratch.covered[at] != 0;
}

double minRefreshTravel(const RefreshTravel& renewal) {
  return std::min({renewal.resting_m, renewal.sliding_m, renewal.rolling_m});
}

// Updates a pair that is due.
void updatePair(IslandStep& step, std::size_t at, const RefreshTravel& renewal, Counters& counters, StageTimes& times) {
  PairTable& pairs = step.engine.pairs;
  const double travel = travelOf(step.engine, at);
  if (!pairs.touches(at)) {
    ++counters.clearanceChecks;
    savePair(step.engine, at);
    pairs.travelAtCheck[at] = travel;
    updateSeparated(step, at, counters, times);
    return;
  }
  const ContactView manifold = contactOf(step.engine, at);
  const double most = refreshTravelOf(manifold, renewal);
  if (!(travel - pairs.travelAtCheck[at] > most)) return;
  savePair(step.engine, at);
  // Blocks that touch along a line, or in a strip so narrow, may touch with other faces after the least motion.
  const bool mayTurnOver = step.pointKind == PointKind::penalty && !(leastWidthOf(step.simulation, manifold) > 2.0 * most);
  const RelativePose pose = mayTurnOver ? RelativePose{} : poseOf(step, pairs.key[at]);
  if (!mayTurnOver && isPoseUnchanged(step, at, pose, travel, most)) return;
  pairs.travelAtCheck[at] = travel;
  refreshManifold(step, at, counters);
  if (pairs.touches(at)) step.engine.contacts.setPose(pairs.contact[at], pose);
}

// Lists the pairs that touch, and those that may use up their clearance in the coming steps. The list becomes invalid when a
// block exceeds the path that is assumed here.
void listActivePairs(IslandStep& step) {
  Engine& engine = step.engine;
  const double falling_m = tuning::kActiveListSteps * step.simulation.scene.gravity.magnitude * step.drift_s * step.drift_s;
  for (const std::int32_t block : step.blocks) {
    const auto b = static_cast<std::size_t>(block);
    engine.scratch.assumedPath[b] = tuning::kActiveListSpeedGrowth * (engine.scratch.path[b] + falling_m);
  }
  const auto pathOf = [&](std::int32_t block) {
    const bool moves = !sleeps(step.simulation, block) || isDriven(step, block);
    return moves ? engine.scratch.assumedPath[static_cast<std::size_t>(block)] : 0.0;
  };
  const std::size_t first = static_cast<std::size_t>(step.pairs.data() - engine.memo.islandPairs.data());
  std::size_t count = 0;
  for (const std::int32_t pair : step.pairs) {
    const auto at = static_cast<std::size_t>(pair);
    const BlockPair& key = engine.pairs.key[at];
    const double left = engine.pairs.clearance[at] - (travelOf(engine, at) - engine.pairs.travelAtCheck[at]);
    if (!engine.pairs.touches(at) && left > tuning::kActiveListSteps * (pathOf(key.a) + pathOf(key.b))) continue;
    engine.scratch.watchedPairs[first + count++] = pair;
  }
  step.activePairs = std::span<const std::int32_t>(engine.scratch.watchedPairs).subspan(first, count);
  step.activeListSteps = tuning::kActiveListSteps;
}

}  // namespace

void findTouching(IslandStep& step) {
  for (const std::int32_t pair : step.pairs) {
    const auto at = static_cast<std::size_t>(pair);
    savePair(step.engine, at);
    if (!step.engine.pairs.touches(at)) updateSeparated(step, at, step.counters, step.times);
  }
}

bool findContacts(IslandStep& step) {
  return updateContacts(step, {kNever, kNever, kNever});
}

void recomputeClearances(IslandStep& step) {
  const bool listed = step.activeListSteps == tuning::kActiveListSteps;
  PairTable& pairs = step.engine.pairs;
  for (const std::int32_t pair : listed ? step.pairs : step.activePairs) {
    const auto at = static_cast<std::size_t>(pair);
    const double travel = travelOf(step.engine, at);
    if (pairs.travelAtCheck[at] <= travel) continue;
    pairs.travelAtCheck[at] = pairs.touches(at) ? -kNever : travel;
    if (!pairs.touches(at)) pairs.clearance[at] = clearanceNow(step.simulation, at);
  }
  if (step.activeListSteps > 0) --step.activeListSteps;  // the start is one step away from the pose of the list
}

namespace {

// What was done for a range of pairs. Wide islands are run side by side, so these are no buffers of the engine.
struct UpdateStatistics {
  Counters counters;
  StageTimes times;  // s of one thread each
};
UpdateStatistics mergeStatistics(UpdateStatistics a, const UpdateStatistics& b) {
  a.counters += b.counters;
  a.times += b.times;
  return a;
}

}  // namespace

void refreshContacts(IslandStep& step, const RefreshTravel& renewal) {
  StageClock clock(step.times);
  const double least = minRefreshTravel(renewal);
  const auto refreshRange = [&](std::size_t first, std::size_t last) {
    UpdateStatistics done;
    for (const std::int32_t pair : step.activePairs.subspan(first, last - first)) {
      const auto at = static_cast<std::size_t>(pair);
      if (step.engine.pairs.touches(at) && isDue(step.engine, at, least))
        updatePair(step, at, renewal, done.counters, done.times);
    }
    return done;
  };
  const UpdateStatistics total =
      mergeRanges(step.activePairs.size(), tuning::kPairChunk, isWide(step), UpdateStatistics{}, refreshRange, mergeStatistics);
  step.counters += total.counters;
  clock.lap(Stage::candidates);
}

bool updateContacts(IslandStep& step, const RefreshTravel& renewal) {
  StageClock clock(step.times);
  double& candidates_s = step.times.seconds[static_cast<std::size_t>(Stage::candidates)];
  double& cubicTests_s = step.times.seconds[static_cast<std::size_t>(Stage::cubicTests)];
  const double cubicBefore_s = cubicTests_s;
  if (step.activeListSteps > 0) --step.activeListSteps;
  const bool inside = addTravel(step);
  const bool list = step.usesActiveList && step.activeListSteps == 0;
  if (step.activeListSteps == 0) step.activePairs = step.pairs;
  const double least = minRefreshTravel(renewal);
  if (!isWide(step)) {
    for (const std::int32_t pair : step.activePairs) {
      const auto at = static_cast<std::size_t>(pair);
      if (!isCovered(step, at) && isDue(step.engine, at, least)) updatePair(step, at, renewal, step.counters, step.times);
    }
    if (list) listActivePairs(step);
    clock.lap(Stage::candidates);
    candidates_s -= cubicTests_s - cubicBefore_s;  // timed within the candidates
    return inside;
  }

  const auto updateRange = [&](std::size_t first, std::size_t last) {
    UpdateStatistics done;
    StageClock all(done.times);
    for (std::size_t i = first; i < last; ++i) {
      const auto at = static_cast<std::size_t>(step.activePairs[i]);
      if (!isCovered(step, at) && isDue(step.engine, at, least)) updatePair(step, at, renewal, done.counters, done.times);
    }
    all.lap(Stage::candidates);
    return done;
  };
  const UpdateStatistics total =
      mergeRanges(step.activePairs.size(), tuning::kPairChunk, true, UpdateStatistics{}, updateRange, mergeStatistics);
  step.counters += total.counters;
  if (list) listActivePairs(step);
  // On many threads the cubic tests get their share of the elapsed time.
  const double before_s = candidates_s;
  clock.lap(Stage::candidates);
  const double all_s = total.times.seconds[static_cast<std::size_t>(Stage::candidates)];
  const double share = all_s > 0.0 ? total.times.seconds[static_cast<std::size_t>(Stage::cubicTests)] / all_s : 0.0;
  cubicTests_s += share * (candidates_s - before_s);
  candidates_s -= share * (candidates_s - before_s);
  return inside;
}

}  // namespace springtower
