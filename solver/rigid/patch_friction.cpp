#include "solver/rigid/patch_friction.h"

#include "core/tuning.h"
#include "solver/contact/slip.h"
#include "solver/rigid/constraints.h"
#include "solver/rigid/packs.h"

#include <cmath>

namespace springtower {

namespace {

// What the choice depends on beside the points.
struct PatchRules {
  double noise_m_s;  // slower slip is none
  bool evens;        // friction of a pair that slips acts as that of even pressure
};

// Velocity along the faces at the points of four pairs, m/s.
SPRINGTOWER_INLINE void slipAt(const PackMotion& motion, const PackedPoint& p, LaneVector& slip) {
  relativeAt(motion, p, slip);
  removeAlong(p.normal, slip);
}

// The pairs of which no point that pushes sticks. One that does not push either has the same friction whether it slips or not,
// where both coefficients are equal.
SPRINGTOWER_INLINE void findFree(const PackedPoints& packed, const PackedPair& pair, LaneMask& isFree) {
  LaneMask sticks{};
  LaneMask pushes = pair.staticFriction != pair.kineticFriction;
  for (const PackedPoint& p : pointsOf(packed, pair)) {
    const LaneMask here = p.push > 0.0;
    sticks |= here & ~p.sliding;
    pushes |= here;
  }
  isFree = pushes & ~sticks;
}

// Whether all points of a pair slip.
bool isSlipping(const IslandStep& step, const PatchRules& rules, const PackedPoints& packed, const PackedPair& pair, int lane,
                const PackMotion& motion) {
  SlipOfPoints slip;
  for (const PackedPoint& p : pointsOf(packed, pair)) {
    if (!(p.normalMass[lane] > 0.0)) continue;
    LaneVector along;
    Lanes squared;
    slipAt(motion, p, along);
    dot(along, along, squared);
    slip.add(p.push[lane] > 0.0, p.sliding[lane] != 0, std::sqrt(squared[lane]));
  }
  return slip.isGross(step.simulation, rules.noise_m_s);
}

// Place of a point, m.
Vec3 meetingPlace(const RigidIsland& island, const PackedPair& pair, const PackedPoint& p, int lane) {
  const std::int32_t upper = pair.upper[static_cast<std::size_t>(lane)];
  const Vec3 arm(p.armUpper.x[lane], p.armUpper.y[lane], p.armUpper.z[lane]);
  return upper == unmovedBody(island) ? arm : arm + island.bodies[static_cast<std::size_t>(upper)].place;
}

Vec3 vectorOf(const LaneVector& from, int lane) {
  return {from.x[lane], from.y[lane], from.z[lane]};
}

// Where the friction of a pair's points acts that all slip.
EvenPressure pressureOn(const RigidIsland& island, const PackedPoints& packed, const PackedPair& pair, int lane,
                        const PackMotion& motion) {
  PatchPoints patch;
  double push = 0.0;
  Vec3 slide = Vec3::Zero();
  for (const PackedPoint& p : pointsOf(packed, pair)) {
    LaneVector along;
    slipAt(motion, p, along);
    patch.add(meetingPlace(island, pair, p, lane), p.push[lane]);
    slide += p.push[lane] * vectorOf(along, lane);
    push += p.push[lane];
  }
  const Vec3 normal = vectorOf(packed.points[static_cast<std::size_t>(pair.first)].normal, lane);
  EvenPressure pressure = evenPressure(patch, normal);
  if (!(push > 0.0)) return pressure;
  const Vec3 spin = vectorOf(motion.spinUpper, lane) - vectorOf(motion.spinLower, lane);
  pressure.shrink = shrinkOf(pressure, normal.dot(spin), slide.norm() / push);
  return pressure;
}

// Lets the friction of a pair act at `shrink` times the points' distance from the centre of pressure.
void moveFriction(const RigidIsland& island, PackedPoints& packed, const PackedPair& pair, int lane,
                  const EvenPressure& pressure) {
  for (PackedPoint& p : pointsOf(packed, pair)) {
    setLane(p.towardsCentre, lane, (1.0 - pressure.shrink) * (pressure.centre - meetingPlace(island, pair, p, lane)));
  }
}

void setStatic(PackedPoints& packed, PackedPair& pair) {
  for (PackedPoint& p : pointsOf(packed, pair)) {
    p.coefficient = pair.staticFriction;
    if (pair.slips) setZero(p.towardsCentre);
  }
  pair.slips = false;
}

SPRINGTOWER_INLINE void chooseOf(const IslandStep& step, const RigidIsland& island, const PatchRules& rules, PackedPoints& packed,
                                 PackedPair& pair) {
  setStatic(packed, pair);
  LaneMask isFree;
  findFree(packed, pair, isFree);
  if (!any(isFree)) return;
  PackMotion motion;
  gather(island.motions.data(), pair, motion);
  for (int lane = 0; lane < kPackedPairs; ++lane) {
    if (isFree[lane] == 0 || pair.group[static_cast<std::size_t>(lane)] < 0) continue;
    if (!isSlipping(step, rules, packed, pair, lane, motion)) continue;
    for (PackedPoint& p : pointsOf(packed, pair)) p.coefficient[lane] = pair.kineticFriction[lane];
    if (!rules.evens) continue;
    const EvenPressure pressure = pressureOn(island, packed, pair, lane, motion);
    if (!(pressure.shrink < 1.0)) continue;
    moveFriction(island, packed, pair, lane, pressure);
    pair.slips = true;
  }
}

SPRINGTOWER_KERNEL
void chooseIn(const IslandStep& step, const RigidIsland& island, const PatchRules& rules, PackedPoints& packed, std::size_t first,
              std::size_t last) {
  for (std::size_t i = first; i < last; ++i) chooseOf(step, island, rules, packed, packed.pairs[i]);
}

}  // namespace

void choosePatchFriction(const IslandStep& step, RigidIsland& island) {
  // Where a fall has too many points for its passes to converge, friction at the points that touch gains no energy.
  const std::size_t all = island.steady.points.size() + island.fast.points.size();
  const bool converges =
      all * static_cast<std::size_t>(tuning::kCheapPasses) <= static_cast<std::size_t>(tuning::kCheapEvaluations);
  const PatchRules rules{slipNoise_m_s(step), converges || isRigid(step.simulation.scene.settings.method)};
  for (PackedPoints* packed : packsOf(island)) {
    overPacks(*packed, [&](std::size_t first, std::size_t last) { chooseIn(step, island, rules, *packed, first, last); });
  }
}

}  // namespace springtower
