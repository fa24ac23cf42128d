#include "solver/rigid/constraints.h"

#include "core/tuning.h"
#include "solver/rigid/over_bodies.h"
#include "solver/rigid/packs.h"

#include <limits>

namespace springtower {

namespace {

// Places and masses of one body of each of four pairs.
struct LanePlace {
  LaneVector centre;
  LaneVector axes[3];
  Lanes inverseMass;
  LaneMatrix inertia;
};

SPRINGTOWER_INLINE void gatherPlaces(const BodyPlace* places, const PackedIndex& at, LanePlace& to) {
  const BodyPlace& a = places[at[0]];
  const BodyPlace& b = places[at[1]];
  const BodyPlace& c = places[at[2]];
  const BodyPlace& d = places[at[3]];
  transpose(a.centre, b.centre, c.centre, d.centre, to.centre);
  for (int k = 0; k < 3; ++k) transpose(a.axes[k], b.axes[k], c.axes[k], d.axes[k], to.axes[k]);
  to.inverseMass = Lanes{a.inverseMass, b.inverseMass, c.inverseMass, d.inverseMass};
  LaneVector column[3];
  for (int k = 0; k < 3; ++k)
    transpose(a.inverseInertia[k], b.inverseInertia[k], c.inverseInertia[k], d.inverseInertia[k], column[k]);
  to.inertia = {column[0].x, column[1].x, column[2].x, column[1].y, column[2].y, column[2].z};
}

// A vector given in the bodies' axes, in the world's.
SPRINGTOWER_INLINE void turned(const LanePlace& body, const LaneVector& own, LaneVector& world) {
  setZero(world);
  addTimes(own.x, body.axes[0], world);
  addTimes(own.y, body.axes[1], world);
  addTimes(own.z, body.axes[2], world);
}

// Contribution of a body to the inverse effective masses at a point.
struct Share {
  Lanes normal;
  Lanes all;  // sum over the three directions
};

SPRINGTOWER_INLINE void shareOf(const LanePlace& body, const LaneVector& arm, const LaneVector& normal, LaneVector& turn,
                                Share& share) {
  LaneVector lever, twice;
  cross(arm, normal, lever);
  times(body.inertia, lever, turn);
  times(body.inertia, arm, twice);
  Lanes leverTurn, arms, armTwice;
  dot(lever, turn, leverTurn);
  dot(arm, arm, arms);
  dot(arm, twice, armTwice);
  const Lanes trace = body.inertia.xx + body.inertia.yy + body.inertia.zz;
  share.normal = body.inverseMass + leverTurn;
  share.all = 3.0 * body.inverseMass + trace * arms - armTwice;
}

SPRINGTOWER_INLINE void placeNormal(const LanePlace& upper, const LanePlace& lower, const PackedPlace& own, LaneVector& normal) {
  LaneVector byUpper, byLower;
  turned(upper, own.normal, byUpper);
  turned(lower, own.normal, byLower);
  const LaneMask withUpper = (own.kind & kTurnsUpper) != 0;
  const LaneMask withLower = (own.kind & kTurnsLower) != 0;
  normal.x = withUpper ? byUpper.x : (withLower ? byLower.x : own.normal.x);
  normal.y = withUpper ? byUpper.y : (withLower ? byLower.y : own.normal.y);
  normal.z = withUpper ? byUpper.z : (withLower ? byLower.z : own.normal.z);
}

// The mean of a point's push over about a frame, without impacts, which push in one substep alone.
SPRINGTOWER_INLINE void followPush(const PackedPoint& p, double share, Lanes& lasting) {
  Lanes acts;
  smallerOf(p.push, p.before, acts);
  lasting += share * (acts - lasting);
}

// As what lasts of a point's force gets less, its springs would push the blocks out by as much, and as it grows, let them in
// again. What they would push out stays an overlap without force instead, and what they let in is taken from that first: pushes
// that vary from substep to substep would keep a heap in motion. (A stack that stands and is hit comes to rest without it.)
SPRINGTOWER_INLINE void followSprings(const PackedPoint& p, const Lanes& before, Lanes& rest, Lanes& gap) {
  const Lanes zero{};
  const Lanes fallen = before - p.deepest;
  const Lanes slack = gap + p.deepest;
  Lanes kept, taken;
  smallerOf(fallen, slack < zero ? -slack : zero, kept);
  largerOf(fallen, -rest, taken);
  const Lanes change = fallen > zero ? kept : taken;
  rest += change;
  gap += change;
}

// By how much a gap closes in a substep beyond what the velocities at its start say, m, <= 0: points of blocks that turn go round
// on circles, and the normal turns under a point that slides. Of second order in the substep's length; blocks that roll over one
// another would sink in by it in every substep. Where it opens a gap it is left out: passes may yet change the motion that it
// rests on.
SPRINGTOWER_INLINE void closingByTurning(const PackMotion& motion, const PackedPlace& own, const PackedPoint& p, double step_s,
                                         Lanes& closing) {
  LaneVector relative, turningUpper, turningLower, inward, inwardLower, spin, turning;
  relativeAt(motion, p, relative);
  cross(motion.spinUpper, p.armUpper, turningUpper);
  cross(motion.spinLower, p.armLower, turningLower);
  cross(motion.spinUpper, turningUpper, inward);
  cross(motion.spinLower, turningLower, inwardLower);
  subtract(inwardLower, inward);
  const Lanes zero{};
  const LaneMask withUpper = (own.kind & kTurnsUpper) != 0;
  const LaneMask withLower = (own.kind & kTurnsLower) != 0;
  spin.x = withUpper ? motion.spinUpper.x : (withLower ? motion.spinLower.x : zero);
  spin.y = withUpper ? motion.spinUpper.y : (withLower ? motion.spinLower.y : zero);
  spin.z = withUpper ? motion.spinUpper.z : (withLower ? motion.spinLower.z : zero);
  cross(spin, p.normal, turning);
  Lanes byPoints, byNormal;
  dot(p.normal, inward, byPoints);
  dot(turning, relative, byNormal);
  smallerOf(step_s * step_s * (0.5 * byPoints + byNormal), zero, closing);
}

SPRINGTOWER_INLINE void placePoint(const LanePlace& upper, const LanePlace& lower, const PackMotion& motion,
                                   const Springs& springs, PackedPlace& own, PackedPoint& p) {
  LaneVector onUpper, onLower;
  turned(upper, own.upper, onUpper);
  add(upper.centre, onUpper);
  turned(lower, own.lower, onLower);
  add(lower.centre, onLower);
  placeNormal(upper, lower, own, p.normal);
  LaneVector apart = onUpper;
  subtract(onLower, apart);
  dot(p.normal, apart, p.gap);
  // 1 % of the overlap without force becomes, in each substep, overlap that is pushed out, as far as energy lost in the frame
  // pays for it. Otherwise what each impact leaves, and each change between springs and impulses, would add up.
  own.rest *= 1.0 - tuning::kRigidModeBaumgarte;
  p.gap += own.rest;
  p.softness = own.compliance / springs.step_s;
  const Lanes tolerance = springs.tolerance_m + Lanes{};
  Lanes before;
  smallerOf(p.softness * own.lasting, tolerance, before);
  followPush(p, springs.share, own.lasting);
  smallerOf(p.softness * own.lasting, tolerance, p.deepest);
  if (springs.heap) followSprings(p, before, own.rest, p.gap);
  p.armUpper = {0.5 * (onUpper.x + onLower.x), 0.5 * (onUpper.y + onLower.y), 0.5 * (onUpper.z + onLower.z)};
  p.armLower = p.armUpper;
  subtract(upper.centre, p.armUpper);
  subtract(lower.centre, p.armLower);
  closingByTurning(motion, own, p, springs.step_s, p.closing);
  Share up, low;
  shareOf(upper, p.armUpper, p.normal, p.turnUpper, up);
  shareOf(lower, p.armLower, p.normal, p.turnLower, low);
  const Lanes normal = up.normal + low.normal;
  // The two tangential directions together have the rest of the sum, and each has at least the inverse masses alone.
  const Lanes across = up.all + low.all - normal - (upper.inverseMass + lower.inverseMass);
  const LaneMask isPoint = p.normalMass > 0.0;
  const Lanes zero = {0.0, 0.0, 0.0, 0.0};
  p.normalMass = isPoint ? 1.0 / normal : zero;
  p.acrossMass = isPoint ? 1.0 / across : zero;
  removeAlong(p.normal, p.friction);
}

// Two blocks are apart by the largest separation along any of their axes. Points of another axis that lie deeper lie beside what
// they seem to touch: they hold nothing before the blocks have come nearer by as much as they are apart.
SPRINGTOWER_INLINE void openBeside(const PackedPair& pair, const Springs& springs, PackedPoints& packed) {
  const Lanes zero{};
  const Lanes none = zero + std::numeric_limits<double>::max();
  Lanes separation[kSeparatingAxes] = {none, none, none};
  for (std::int32_t row = pair.first; row < pair.first + pair.rows; ++row) {
    const PackedPlace& own = packed.places[static_cast<std::size_t>(row)];
    const Lanes gap = packed.points[static_cast<std::size_t>(row)].gap - own.rest + own.beside;
    for (std::size_t k = 0; k < kSeparatingAxes; ++k) {
      const Lanes along = (((own.kind & kAxisBit << k) != 0) & (own.rest < none)) ? gap : none;
      smallerOf(along, separation[k], separation[k]);
    }
  }
  Lanes apart = zero;
  for (const Lanes& along : separation) {
    const Lanes listed = along < none ? along : zero;
    largerOf(listed, apart, apart);
  }
  if (!any(apart > zero)) return;
  for (std::int32_t row = pair.first; row < pair.first + pair.rows; ++row) {
    const PackedPlace& own = packed.places[static_cast<std::size_t>(row)];
    PackedPoint& p = packed.points[static_cast<std::size_t>(row)];
    LaneMask isBeside{};
    for (std::size_t k = 0; k < kSeparatingAxes; ++k)
      isBeside |= ((own.kind & kAxisBit << k) != 0) & (separation[k] < apart - springs.rounding_m);
    p.gap = (isBeside & (apart > zero) & (p.gap < apart)) ? apart : p.gap;
  }
}

SPRINGTOWER_KERNEL
void placePacks(const RigidIsland& island, const Springs& springs, PackedPoints& packed, std::size_t first, std::size_t last) {
  for (std::size_t i = first; i < last; ++i) {
    PackedPair& pair = packed.pairs[i];
    LanePlace upper{};
    LanePlace lower{};
    gatherPlaces(island.places.data(), pair.upper, upper);
    gatherPlaces(island.places.data(), pair.lower, lower);
    PackMotion motion;
    gather(island.motions.data(), pair, motion);
    pair.inverseMassUpper = upper.inverseMass;
    pair.inverseMassLower = lower.inverseMass;
    pair.inertiaUpper = upper.inertia;
    pair.inertiaLower = lower.inertia;
    for (std::int32_t row = pair.first; row < pair.first + pair.rows; ++row)
      placePoint(upper, lower, motion, springs, packed.places[static_cast<std::size_t>(row)],
                 packed.points[static_cast<std::size_t>(row)]);
    openBeside(pair, springs, packed);
  }
}

SPRINGTOWER_KERNEL
void moveGapsOf(const BodyMotion* moved, PackedPoints& packed, std::size_t first, std::size_t last) {
  for (std::size_t i = first; i < last; ++i) {
    const PackedPair& pair = packed.pairs[i];
    PackMotion motion;
    gather(moved, pair, motion);
    for (PackedPoint& p : pointsOf(packed, pair)) {
      LaneVector relative;
      relativeAt(motion, p, relative);
      Lanes opening;
      dot(p.normal, relative, opening);
      p.gap += opening + p.closing;
    }
  }
}

}  // namespace

void placeConstraints(const RigidIsland& island, const Springs& springs, PackedPoints& packed) {
  overPacks(packed, [&](std::size_t first, std::size_t last) { placePacks(island, springs, packed, first, last); });
}

void moveGaps(RigidIsland& island) {
  overBodies(island, [&](std::size_t i) {
    toLanes(island.bodies[i].moved, island.motions[i].linear);
    toLanes(island.bodies[i].turned, island.motions[i].angular);
  });
  for (ActingPoints* list : {&island.steady, &island.fast}) {
    PackedPoints& packed = list->packed;
    overPacks(packed, [&](std::size_t first, std::size_t last) { moveGapsOf(island.motions.data(), packed, first, last); });
  }
}

void readBodies(RigidIsland& island) {
  const Lanes zero = {0.0, 0.0, 0.0, 0.0};
  island.places.resize(island.bodies.size() + 1);
  island.motions.resize(island.bodies.size() + 1);
  overBodies(island, [&](std::size_t i) {
    const RigidBody& body = island.bodies[i];
    BodyPlace& place = island.places[i];
    toLanes(body.place, place.centre);
    for (int k = 0; k < 3; ++k) {
      toLanes(body.axes.col(k), place.axes[k]);
      toLanes(body.inverseInertia.col(k), place.inverseInertia[k]);
    }
    place.inverseMass = body.inverseMass;
    place.flies = body.pushed || body.inverseMass == 0.0 ? 0.0 : 1.0;
  });
  BodyPlace& still = island.places.back();
  still = BodyPlace{};
  still.centre = zero;
  for (int k = 0; k < 3; ++k) {
    still.axes[k] = still.inverseInertia[k] = zero;
    still.axes[k][k] = 1.0;
  }
  island.motions.back() = {zero, zero};
  readVelocities(island);
}

void readVelocities(RigidIsland& island) {
  overBodies(island, [&](std::size_t i) {
    toLanes(island.bodies[i].velocity, island.motions[i].linear);
    toLanes(island.bodies[i].spin, island.motions[i].angular);
  });
}

void writeBodies(RigidIsland& island) {
  overBodies(island, [&](std::size_t i) {
    fromLanes(island.motions[i].linear, island.bodies[i].velocity);
    fromLanes(island.motions[i].angular, island.bodies[i].spin);
  });
}

}  // namespace springtower
