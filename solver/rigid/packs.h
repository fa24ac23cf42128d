#pragma once

#include "core/lane_vector.h"
#include "core/parallel.h"
#include "core/tuning.h"
#include "solver/world/island_step.h"
#include "solver/world/packed_points.h"
#include "solver/world/rigid_island.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace springtower {

/// Packs the points of a list for the substeps that follow: colours its pairs, and sets impulses, places and what else does not
/// change with the poses. The same list gives the same packs.
void packPoints(const IslandStep& step, const RigidIsland& island, ActingPoints& list);

/// Lists the packs of each body, unless they have been since the points were packed: passes through impacts alone need them.
void listPairsOfBodies(const RigidIsland& island, PackedPoints& packed);

/// What placing and passes have changed in a group's points, from the packs to the list; of all groups.
void unpackGroup(ActingPoints& list, const PointGroup& group);
void unpackPoints(ActingPoints& list);

/// Points of this group act no longer: neither touch they nor may they in this step.
void disablePacked(PackedPoints& packed, const PointGroup& group);

/// Runs kernel(first, last) over the ranges of colours that begin at `start`, one after the other; that of a colour on many
/// threads where it is long, and those of short ones together.
template <class Kernel>
void overColours(const std::vector<std::int32_t>& start, const Kernel& kernel) {
  std::size_t done = 0;
  for (std::size_t colour = 0; colour + 1 < start.size(); ++colour) {
    const auto first = static_cast<std::size_t>(start[colour]);
    const auto last = static_cast<std::size_t>(start[colour + 1]);
    if (last - first < 2 * tuning::kPackGrain) continue;
    if (done < first) kernel(done, first);
    forEqualRanges(last - first, tuning::kPackGrain, true,
                   [&](std::size_t from, std::size_t to) { kernel(first + from, first + to); });
    done = last;
  }
  const std::size_t end = start.empty() ? 0 : static_cast<std::size_t>(start.back());
  if (done < end) kernel(done, end);
}

/// Runs kernel(first, last) over packed.pairs in any order: it changes no bodies.
template <class Kernel>
void overPacks(const PackedPoints& packed, const Kernel& kernel) {
  const std::size_t count = packed.pairs.size();
  forEqualRanges(count, tuning::kPackGrain, count >= 2 * tuning::kPackGrain, kernel);
}

/// The packed points of four pairs.
SPRINGTOWER_INLINE std::span<PackedPoint> pointsOf(PackedPoints& packed, const PackedPair& pair) {
  return {packed.points.data() + pair.first, static_cast<std::size_t>(pair.rows)};
}
SPRINGTOWER_INLINE std::span<const PackedPoint> pointsOf(const PackedPoints& packed, const PackedPair& pair) {
  return {packed.points.data() + pair.first, static_cast<std::size_t>(pair.rows)};
}

/// Motion of the bodies of four pairs.
struct PackMotion {
  LaneVector velocityUpper;
  LaneVector spinUpper;
  LaneVector velocityLower;
  LaneVector spinLower;
};

SPRINGTOWER_INLINE void gather(const BodyMotion* bodies, const PackedIndex& at, LaneVector& linear, LaneVector& angular) {
  const BodyMotion& a = bodies[at[0]];
  const BodyMotion& b = bodies[at[1]];
  const BodyMotion& c = bodies[at[2]];
  const BodyMotion& d = bodies[at[3]];
  transpose(a.linear, b.linear, c.linear, d.linear, linear);
  transpose(a.angular, b.angular, c.angular, d.angular, angular);
}

SPRINGTOWER_INLINE void gather(const BodyMotion* bodies, const PackedPair& pair, PackMotion& motion) {
  gather(bodies, pair.upper, motion.velocityUpper, motion.spinUpper);
  gather(bodies, pair.lower, motion.velocityLower, motion.spinLower);
}

/// Of the bodies that move by impulses; others may be in many pairs of a colour.
SPRINGTOWER_INLINE void scatter(const LaneVector& linear, const LaneVector& angular, const PackedIndex& at, std::uint8_t moves,
                                BodyMotion* bodies) {
  Lanes moved[kPackedPairs];
  Lanes turned[kPackedPairs];
  transpose(linear, moved[0], moved[1], moved[2], moved[3]);
  transpose(angular, turned[0], turned[1], turned[2], turned[3]);
  for (int lane = 0; lane < kPackedPairs; ++lane) {
    if ((moves >> lane & 1) == 0) continue;
    bodies[at[static_cast<std::size_t>(lane)]] = {moved[lane], turned[lane]};
  }
}

SPRINGTOWER_INLINE void scatter(const PackMotion& motion, const PackedPair& pair, BodyMotion* bodies) {
  scatter(motion.velocityUpper, motion.spinUpper, pair.upper, pair.movesUpper, bodies);
  scatter(motion.velocityLower, motion.spinLower, pair.lower, pair.movesLower, bodies);
}

/// Velocity of upper against lower at a point, m/s.
SPRINGTOWER_INLINE void relativeAt(const PackMotion& motion, const PackedPoint& p, LaneVector& relative) {
  LaneVector turningUpper, turningLower;
  cross(motion.spinUpper, p.armUpper, turningUpper);
  cross(motion.spinLower, p.armLower, turningLower);
  relative = motion.velocityUpper;
  add(turningUpper, relative);
  subtract(motion.velocityLower, relative);
  subtract(turningLower, relative);
}

/// How far the blocks are apart, m, beyond what their push may compress the springs; negative where they are to be pushed apart.
SPRINGTOWER_INLINE void slackOf(const PackedPoint& p, Lanes& slack) {
  Lanes compressed;
  smallerOf(p.softness * p.push, p.deepest, compressed);
  slack = p.gap + compressed;
}

/// A symmetric matrix times a vector.
SPRINGTOWER_INLINE void times(const LaneMatrix& m, const LaneVector& v, LaneVector& to) {
  to.x = m.xx * v.x + m.xy * v.y + m.xz * v.z;
  to.y = m.xy * v.x + m.yy * v.y + m.yz * v.z;
  to.z = m.xz * v.x + m.yz * v.y + m.zz * v.z;
}

}  // namespace springtower
