#include "solver/law/contact_force.h"

#include "core/lanes.h"
#include "core/tuning.h"
#include "solver/law/pair_geometry.h"
#include "solver/law/point_lanes.h"

#include <algorithm>
#include <cmath>

namespace springtower {

namespace {

// Times the coefficient of friction, of points that stick whatever the force.
constexpr double kStickingFriction = 1e6;

constexpr double kUnbounded = 1e300;

struct LawStep {
  const ContactLaw& law;
  const ContactStep& step;
  double stiffness;       // N/m
  double friction;        // Coulomb's coefficient
  double freedPerSlip;    // rest depth that fades per length of slip
  double impactFactor;    // stiffness scale per squared approach speed
  double stiffeningKeep;  // factor on a stiffening beyond 1 after the step
  double maxwellGain;     // share of its lag that the Maxwell branch loses in the step
  double mostRate;        // 1/s, bound of a damping velocity over the elastic depth
  double smoothing_j;     // of this contact
  double pointMass;       // kg, lower bound of the mass of a point: all four of a face that is hit flat push and squash the block
};

SPRINGTOWER_INLINE LawStep lawStep(const ContactView& m, const ContactLaw& law, const ContactStep& step, double reducedMass) {
  const double aim = law.impactPenetration_m;
  const double stiffness = law.stiffnessOf(m.upper, m.lower);
  const Friction friction = law.friction->of(m.upper, m.lower);
  return {law,
          step,
          stiffness,
          m.slips ? friction.kineticFriction : friction.staticFriction,
          law.restDepthPerSlip * friction.kineticFriction,
          reducedMass / (stiffness * aim * aim),
          1.0 / (1.0 + step.advance_s / law.stiffeningTime_s),
          step.advance_s / (law.maxwellTime_s + step.advance_s),
          step.endOnly && step.advance_s > 0.0 ? 1.0 / step.advance_s : kUnbounded,
          step.smoothing_j > 0.0 ? step.smoothing_j * smoothingShare(*law.stiffness, m.upper, m.lower) : 0.0,
          reducedMass / tuning::kFlatImpactInverseMass};
}

SPRINGTOWER_INLINE bool any(const LaneMask& mask) {
  return (mask[0] | mask[1] | mask[2] | mask[3]) != 0;
}

// Normal state of four points.
struct PointState {
  LaneMask touching;
  LaneMask known;   // those that touched before
  Lanes stiffness;  // N/m
  Lanes bounding;   // N, normal force that bounds friction
};

// Motion of four points: the velocity of upper against lower, m/s, and the one that moved them since they were last advanced.
struct PointMotion {
  const Lanes* relative;
  const Lanes* carried;
};

SPRINGTOWER_INLINE void closingOf(const Lanes* relative, const double* normal, Lanes& closing) {
  closing = -(relative[0] * normal[0] + relative[1] * normal[1] + relative[2] * normal[2]);
}

// The tangential part of the law, for points with the normal force p.normalForce where friction acts with `motion`: advances the
// displacement, keeps it tangential, and bounds it by the cone.
SPRINGTOWER_INLINE void frictionLaw(const LawStep& s, const PointState& state, const PointMotion& motion, const double* normal,
                                    PointLanes& p) {
  const Lanes* relative = motion.relative;
  const Lanes* carried = motion.carried;
  Lanes closing;
  closingOf(relative, normal, closing);
  const Lanes zero = {0.0, 0.0, 0.0, 0.0};
  const Lanes one = zero + 1.0;
  const ContactLaw& law = s.law;
  const LaneMask touching = state.touching;
  const Lanes push = p.normalForce;
  const Lanes carriedNormal = carried[0] * normal[0] + carried[1] * normal[1] + carried[2] * normal[2];
  Lanes displacement[3];
  Lanes slip[3];
  for (int a = 0; a < 3; ++a) {
    displacement[a] = p.displacement[a] + (carried[a] - carriedNormal * normal[a]) * s.step.advance_s;
    slip[a] = relative[a] + closing * normal[a];
  }
  const Lanes outOfPlane = displacement[0] * normal[0] + displacement[1] * normal[1] + displacement[2] * normal[2];
  const Lanes tangential = state.stiffness * law.tangentialRatio;
  Lanes friction[3];
  for (int a = 0; a < 3; ++a) {
    displacement[a] -= outOfPlane * normal[a];
    friction[a] = -tangential * (displacement[a] + law.dampingTime_s * slip[a]);
  }
  const Lanes squared = friction[0] * friction[0] + friction[1] * friction[1] + friction[2] * friction[2];
  const Lanes sticking = s.friction * state.bounding;
  const LaneMask slides = squared > sticking * sticking;
  if (!any(slides)) {
    p.slipRatio = zero;
    for (int a = 0; a < 3; ++a) {
      p.displacement[a] = touching ? displacement[a] : zero;
      p.force[a] = push * normal[a] + friction[a];
    }
    return;
  }
  Lanes size;
  squareRoot(squared, size);
  const Lanes keep = slides ? sticking / size : one;
  p.slipRatio = slides & touching ? (keep > tuning::kMinSlipRatio ? keep : zero + tuning::kMinSlipRatio) : zero;
  // Slip releases a little of the rest depth; the work is at most what friction dissipates.
  Lanes displacementSize;
  squareRoot(displacement[0] * displacement[0] + displacement[1] * displacement[1] + displacement[2] * displacement[2],
             displacementSize);
  const Lanes freed = p.restDepth - s.freedPerSlip * (1.0 - keep) * displacementSize;
  p.restDepth = state.known ? (freed > zero ? freed : zero) : p.restDepth;
  for (int a = 0; a < 3; ++a) {
    p.displacement[a] = touching ? displacement[a] * keep : zero;
    p.force[a] = push * normal[a] + friction[a] * keep;
  }
}

// The law of smoothed contacts, without damping. Stiffening and rest depth are those of the tangent to the normal force, so that
// the linearised contact is what it is for others. The tangential stiffness follows that of the row's stiffest point, and only
// between steps: so the forces of a step in which nothing slips have a potential. Friction is kept where that stiffness grows.
SPRINGTOWER_INLINE void smoothedLaw(const LawStep& s, const Lanes& depth, const PointMotion& motion, const double* normal,
                                    const Lanes& inUse, PointLanes& p) {
  const Lanes zero = {0.0, 0.0, 0.0, 0.0};
  const LaneMask used = inUse > zero;
  const auto stiffest = [&p] {
    return std::max(std::max(p.stiffening[0], p.stiffening[1]), std::max(p.stiffening[2], p.stiffening[3]));
  };
  Lanes root;
  squareRoot(depth * depth + 4.0 * s.smoothing_j / s.stiffness, root);
  double holding = stiffest();
  p.stiffening = used ? 0.5 * (1.0 + depth / root) : zero;
  if (s.step.advance_s == 0.0) {
    const double kept = std::min(1.0, holding / stiffest());
    for (Lanes& along : p.displacement) along *= kept;
    holding = stiffest();
  }
  p.restDepth = depth - root;
  p.maxwellDepth = zero;
  p.touching = used ? zero + 1.0 : zero;
  p.normalForce = used ? 0.5 * s.stiffness * (depth + root) : zero;
  Lanes bounding = p.normalForce;
  if (s.step.sticks) bounding = p.normalForce * kStickingFriction;
  frictionLaw(s, {used, used, zero + s.stiffness * holding, bounding}, motion, normal, p);
}

// The contact law on four points. `relative` is the velocity of upper against lower there, `slip` the motion where friction acts;
// `inUse` is 1 for lanes that hold a point.
SPRINGTOWER_INLINE void pointLaw(const LawStep& s, const Lanes& depth, const Lanes* relative, const PointMotion& slip,
                                 const double* normal, const Lanes& inUse, PointLanes& p) {
  const Lanes zero = {0.0, 0.0, 0.0, 0.0};
  const Lanes one = zero + 1.0;
  const ContactLaw& law = s.law;
  Lanes closing;
  closingOf(relative, normal, closing);

  // First contact: the rest depth is the depth when it is detected (explicit steps) or 0 (implicit steps), so the spring starts
  // unloaded and adds no energy. Stiffness is multiplied so that the impact at the present closing speed stops within the impact
  // depth. The rest depth shrinks with the depth as the point lifts, while the spring stores nothing.
  if (s.smoothing_j > 0.0) {
    smoothedLaw(s, depth, slip, normal, inUse, p);
    return;
  }
  const LaneMask touching = (depth > zero) & (inUse > zero);
  const LaneMask known = touching & (p.touching > zero);
  Lanes impact = s.impactFactor * closing * closing;
  impact = impact > one ? impact : one;
  impact = impact < s.step.maxStiffening ? impact : zero + s.step.maxStiffening;
  p.stiffening = known ? 1.0 + (p.stiffening - 1.0) * s.stiffeningKeep : impact;
  const Lanes lower = p.restDepth < depth ? p.restDepth : depth;
  p.restDepth = known ? lower : (s.step.endOnly ? zero : depth);

  const Lanes elastic = depth - p.restDepth;
  const Lanes maxwell = p.maxwellDepth + (elastic - p.maxwellDepth) * s.maxwellGain;
  const Lanes pushedOut =
      elastic * (1.0 + 1.0 / std::max(law.maxwellRatio, tuning::kMinMaxwellRatio));  // beyond this the Maxwell branch would pull
  p.maxwellDepth = known ? (maxwell < pushedOut ? maxwell : pushedOut) : zero;
  const Lanes stiffness = s.stiffness * p.stiffening;
  // A spring that begins to push inside an implicit step has been closing for a part of it. The damping velocity is limited to
  // elastic depth / step: otherwise the damping force would jump where the spring begins, and the step equation might have no
  // solution.
  const Lanes mostDamped = elastic * s.mostRate;
  const Lanes damped = closing < mostDamped ? closing : mostDamped;
  Lanes push = stiffness * (elastic + law.maxwellRatio * (elastic - p.maxwellDepth) + law.dampingTime_s * damped);
  push = (touching & (push > zero) & (elastic > zero)) ? push : zero;
  if (s.step.kick_s > 0.0 && any(p.stiffening > one)) {
    // A point that rebounds within the step receives no more energy than its kinetic energy and that of its spring.
    const Lanes spring = stiffness * (elastic + law.maxwellRatio * (elastic - p.maxwellDepth));
    const Lanes given = closing * closing + spring * (elastic - closing * s.step.kick_s) / s.pointMass;
    Lanes back;
    squareRoot(given > zero ? given : zero, back);
    const Lanes most = (closing + back) * (s.pointMass / s.step.kick_s);
    push = ((p.stiffening > one) & (push > most)) ? (most > zero ? most : zero) : push;
  }
  p.touching = touching ? (push > zero ? one : zero + kTouchingWithoutForce) : zero;
  p.normalForce = push;
  Lanes bounding = push;
  if (s.step.sticks) bounding = push * kStickingFriction;
  frictionLaw(s, {touching, known, stiffness, bounding}, slip, normal, p);
}

// Sums of three lane vectors at once: [sum a, sum b, sum c, 0].
SPRINGTOWER_INLINE void sums(const Lanes& a, const Lanes& b, const Lanes& c, Lanes& result) {
  const Lanes none = {0.0, 0.0, 0.0, 0.0};
  Lanes even, odd;
  shuffle<0, 4, 2, 6>(a, b, even);
  shuffle<1, 5, 3, 7>(a, b, odd);
  const Lanes ab = even + odd;
  shuffle<0, 4, 2, 6>(c, none, even);
  shuffle<1, 5, 3, 7>(c, none, odd);
  const Lanes cd = even + odd;
  shuffle<0, 1, 4, 5>(ab, cd, even);
  shuffle<2, 3, 6, 7>(ab, cd, odd);
  result = even + odd;
}

// Writes [force, moment along u, moment along v] of one component to a block's affine forces.
SPRINGTOWER_INLINE void place(const Lanes& total, double sign, const FaceAxes& face, std::size_t k, AffineField& force) {
  force.centre[k] = sign * total[0];
  force.side[face.across][k] = sign * face.side * total[0];
  force.side[face.u][k] = sign * total[1];
  force.side[face.v][k] = sign * total[2];
}

// A face of a block: its place, its motion, and the motion that moved it.
struct MovingFace {
  FaceField place;
  FaceField motion;
  FaceField carried;
};

template <bool SameMotion>
SPRINGTOWER_INLINE void movingFaceOf(const ContactSide& side, const FaceAxes& axes, MovingFace& face) {
  faceOf(side.frame->place, axes, face.place);
  faceOf(*side.motion, axes, face.motion);
  if (!SameMotion) faceOf(*side.carried, axes, face.carried);
}

// The surface under a face: the floor, or the face of another block.
struct FaceBelow {
  MovingFace face;
  double normal[3] = {0.0, 0.0, 1.0};
  double dualU[3];
  double dualV[3];
};

// Four points between two faces, at `u` and `v` of the upper one.
struct FacePoints {
  Lanes u, v;
  Lanes lowerU, lowerV;
  Lanes depth;
  Lanes point[3];     // m, on the upper face
  Lanes relative[3];  // m/s, of upper against lower
  Lanes carried[3];   // m/s
};

template <bool Floor, bool SameMotion>
SPRINGTOWER_INLINE void placePoints(const MovingFace& upper, const FaceBelow& lower, FacePoints& p) {
  const Lanes zero = {0.0, 0.0, 0.0, 0.0};
  const double* normal = lower.normal;
  at(upper.place, p.u, p.v, p.point);
  at(upper.motion, p.u, p.v, p.relative);
  if (!SameMotion) at(upper.carried, p.u, p.v, p.carried);
  p.depth = -p.point[2];
  p.lowerU = zero;
  p.lowerV = zero;
  if (Floor) return;
  Lanes arm[3];
  for (int k = 0; k < 3; ++k) arm[k] = p.point[k] - lower.face.place.centre[k];
  p.depth = -(arm[0] * normal[0] + arm[1] * normal[1] + arm[2] * normal[2]);
  p.lowerU = arm[0] * lower.dualU[0] + arm[1] * lower.dualU[1] + arm[2] * lower.dualU[2];
  p.lowerV = arm[0] * lower.dualV[0] + arm[1] * lower.dualV[1] + arm[2] * lower.dualV[2];
  Lanes below[3];
  at(lower.face.motion, p.lowerU, p.lowerV, below);
  for (int k = 0; k < 3; ++k) p.relative[k] -= below[k];
  if (SameMotion) return;
  at(lower.face.carried, p.lowerU, p.lowerV, below);
  for (int k = 0; k < 3; ++k) p.carried[k] -= below[k];
}

void reportFace(const FacePoints& p, const FacePoints& slip, const PointLanes& points, const double* normal, std::size_t first,
                std::size_t count, PointForces& report) {
  for (std::size_t i = 0; i < 4 && first + i < count; ++i) {
    const std::size_t to = first + i;
    report.depth[to] = p.depth[i];
    report.normal[to] = points.normalForce[i];
    report.direction = Vec3(normal[0], normal[1], normal[2]);
    report.place[to] = Vec3(p.point[0][i], p.point[1][i], p.point[2][i]);
    report.lowerPlace[to] = report.place[to] + p.depth[i] * report.direction;
    report.slipPlace[to] = Vec3(slip.point[0][i], slip.point[1][i], slip.point[2][i]);
    report.lowerSlipPlace[to] = report.slipPlace[to] + slip.depth[i] * report.direction;
    for (std::size_t k = 0; k < 3; ++k) report.friction[to][k] = points.force[k][i] - points.normalForce[i] * normal[k];
  }
}

// Friction that acts nearer to the centre of pressure, as forces at the points themselves: the same sum and moment.
void spreadFriction(std::size_t count, double shrink, PointForces& report) {
  double push = 0.0;
  std::array<double, 3> sum{};
  for (std::size_t i = 0; i < count; ++i) {
    push += report.normal[i];
    for (std::size_t k = 0; k < 3; ++k) sum[k] += report.friction[i][k];
  }
  if (!(push > 0.0)) return;
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t k = 0; k < 3; ++k)
      report.friction[i][k] = shrink * report.friction[i][k] + (1.0 - shrink) * report.normal[i] / push * sum[k];
  }
}

// Where the friction of four points acts that slip with all of their contact.
template <bool Floor, bool SameMotion>
SPRINGTOWER_INLINE void placeSlip(const SlipPatch& patch, const MovingFace& upper, const FaceBelow& lower, const FacePoints& p,
                                  FacePoints& slip) {
  const auto u = static_cast<double>(patch.u);
  const auto v = static_cast<double>(patch.v);
  const auto shrink = static_cast<double>(patch.shrink);
  slip.u = u + shrink * (p.u - u);
  slip.v = v + shrink * (p.v - v);
  placePoints<Floor, SameMotion>(upper, lower, slip);
}

// Adds the forces of four points to the sums on both blocks; friction acts at `slip`, which are the points unless all slip.
template <bool Floor, bool Slips>
SPRINGTOWER_INLINE void addPointForces(const FacePoints& p, const FacePoints& slip, const PointLanes& points,
                                       const double* normal, Lanes* onUpper, Lanes* onLower) {
  for (int k = 0; k < 3; ++k) {
    const Lanes& f = points.force[k];
    const Lanes push = points.normalForce * normal[k];
    const Lanes across = f - push;
    Lanes total;
    if (Slips) {
      sums(f, push * p.u + across * slip.u, push * p.v + across * slip.v, total);
    } else {
      sums(f, f * p.u, f * p.v, total);
    }
    onUpper[k] += total;
    if (Floor) continue;
    if (Slips) {
      sums(f, push * p.lowerU + across * slip.lowerU, push * p.lowerV + across * slip.lowerV, total);
    } else {
      sums(f, f * p.lowerU, f * p.lowerV, total);
    }
    onLower[k] += total;
  }
}

// `Slips`: all of its points slip.
template <bool Floor, bool SameMotion, bool Slips>
SPRINGTOWER_INLINE void faceForces(const ContactView& m, const ContactSide& upper, const ContactSide& lower, const LawStep& law,
                                   const PointRows* keep, PairForce& result, PointForces* report) {
  const FaceAxes& upperFace = kFaceAxes[static_cast<std::size_t>(m.incidentFace)];
  const FaceAxes& lowerFace = kFaceAxes[static_cast<std::size_t>(m.referenceFace)];
  MovingFace above;
  FaceBelow below;
  movingFaceOf<SameMotion>(upper, upperFace, above);
  if (!Floor) {
    movingFaceOf<SameMotion>(lower, lowerFace, below.face);
    for (std::size_t k = 0; k < 3; ++k) {
      below.normal[k] = 2.0 * lowerFace.side * lower.frame->normal[lowerFace.across][k];
      below.dualU[k] = lower.frame->dual[lowerFace.u][k];
      below.dualV[k] = lower.frame->dual[lowerFace.v][k];
    }
  }

  const Lanes zero = {0.0, 0.0, 0.0, 0.0};
  Lanes onUpper[3];
  Lanes onLower[3];
  onUpper[0] = onUpper[1] = onUpper[2] = zero;
  onLower[0] = onLower[1] = onLower[2] = zero;
  const auto count = static_cast<std::size_t>(m.count);
  for (std::size_t row = 0, first = 0; first < count; ++row, first += kRowPoints) {
    const PlaceRow& place = *m.place[row];
    FacePoints p;
    load(place.u.data(), p.u);
    load(place.v.data(), p.v);
    const double left = static_cast<double>(count - first);
    const Lanes inUse = Lanes{0.0, 1.0, 2.0, 3.0} < left ? zero + 1.0 : zero;
    placePoints<Floor, SameMotion>(above, below, p);
    FacePoints shrunk;
    if (Slips) placeSlip<Floor, SameMotion>(m.patch, above, below, p, shrunk);
    const FacePoints& slip = Slips ? shrunk : p;

    PointLanes points;
    loadPoints(m.points[row]->penalty, points);
    pointLaw(law, p.depth, p.relative, {slip.relative, SameMotion ? slip.relative : slip.carried}, below.normal, inUse, points);
    if (keep != nullptr) storePoints(points, (*keep)[row]->penalty);
    addPointForces<Floor, Slips>(p, slip, points, below.normal, onUpper, onLower);
    if (report != nullptr) reportFace(p, slip, points, below.normal, first, count, *report);
  }
  if (Slips && report != nullptr) spreadFriction(count, static_cast<double>(m.patch.shrink), *report);
  for (std::size_t k = 0; k < 3; ++k) {
    place(onUpper[k], 1.0, upperFace, k, result.upper);
    if (!Floor) place(onLower[k], -1.0, lowerFace, k, result.lower);
  }
}

// Crossing edges: one point, whose normal is the edges' common normal and whose places are those of closest approach.
SPRINGTOWER_INLINE void edgeForces(const ContactView& m, const ContactSide& upper, const ContactSide& lower, const LawStep& law,
                                   const PointRows* keep, PairForce& result, PointForces* report) {
  const EdgeAxes edgeUpper = edgeAxes(m.incidentFace);
  const EdgeAxes edgeLower = edgeAxes(m.referenceFace);
  Crossing crossing;
  crossingOf(upper.frame->place, edgeUpper, lower.frame->place, edgeLower, crossing);
  const double* normal = crossing.normal;
  const double t1 = crossing.onUpper;
  const double t2 = crossing.onLower;
  const double depth = -crossing.gap;

  const Lanes zero = {0.0, 0.0, 0.0, 0.0};
  Lanes relative[3], carried[3];
  for (std::size_t k = 0; k < 3; ++k) {
    relative[k] = zero + (onEdge(*upper.motion, edgeUpper, t1, k) - onEdge(*lower.motion, edgeLower, t2, k));
    carried[k] = zero + (onEdge(*upper.carried, edgeUpper, t1, k) - onEdge(*lower.carried, edgeLower, t2, k));
  }
  PointLanes points;
  loadPoints(m.penalty(0), points);
  pointLaw(law, zero + depth, relative, {relative, carried}, normal, Lanes{1.0, 0.0, 0.0, 0.0}, points);
  if (keep != nullptr) storePoints(points, (*keep)[0]->penalty);
  const auto apply = [](const EdgeAxes& edge, double t, double f, std::size_t k, AffineField& force) {
    force.centre[k] = f;
    force.side[edge.along][k] = t * f;
    force.side[edge.first][k] = edge.sideFirst * f;
    force.side[edge.second][k] = edge.sideSecond * f;
  };
  for (std::size_t k = 0; k < 3; ++k) {
    apply(edgeUpper, t1, points.force[k][0], k, result.upper);
    apply(edgeLower, t2, -points.force[k][0], k, result.lower);
  }
  if (report != nullptr) {
    report->depth[0] = depth;
    report->normal[0] = points.normalForce[0];
    report->direction = Vec3(normal[0], normal[1], normal[2]);
    for (std::size_t k = 0; k < 3; ++k) {
      report->friction[0][k] = points.force[k][0] - points.normalForce[0] * normal[k];
      report->place[0][static_cast<Eigen::Index>(k)] = onEdge(upper.frame->place, edgeUpper, t1, k);
      report->lowerPlace[0][static_cast<Eigen::Index>(k)] = onEdge(lower.frame->place, edgeLower, t2, k);
    }
    report->slipPlace[0] = report->place[0];
    report->lowerSlipPlace[0] = report->lowerPlace[0];
  }
}

SPRINGTOWER_INLINE void evaluate(const ContactView& m, const ContactSide& upper, const ContactSide& lower, const LawStep& law,
                                 const PointRows* keep, PairForce& result, PointForces* report) {
  const bool same = upper.carried == upper.motion;
  if (m.phase == PairPhase::edge) {
    edgeForces(m, upper, lower, law, keep, result, report);
  } else if (m.slips && m.patch.shrink < 1.0F) {
    m.lower < 0 ? faceForces<true, false, true>(m, upper, lower, law, keep, result, report)
                : faceForces<false, false, true>(m, upper, lower, law, keep, result, report);
  } else if (m.lower < 0) {
    same ? faceForces<true, true, false>(m, upper, lower, law, keep, result, report)
         : faceForces<true, false, false>(m, upper, lower, law, keep, result, report);
  } else {
    same ? faceForces<false, true, false>(m, upper, lower, law, keep, result, report)
         : faceForces<false, false, false>(m, upper, lower, law, keep, result, report);
  }
}

}  // namespace

SPRINGTOWER_KERNEL
void manifoldForces(const ContactView& manifold, const ContactSide& upper, const ContactSide& lower, const ContactLaw& law,
                    const ContactStep& step, double reducedMass_kg, const PointRows* keep, PairForce& result) {
  const LawStep constants = lawStep(manifold, law, step, reducedMass_kg);
  evaluate(manifold, upper, lower, constants, keep, result, nullptr);
}

SPRINGTOWER_KERNEL
PointForces pointForces(const ContactView& manifold, const ContactSide& upper, const ContactSide& lower, const ContactLaw& law) {
  PairForce unused;
  PointForces report;
  const ContactStep now;
  evaluate(manifold, upper, lower, lawStep(manifold, law, now, 0.0), nullptr, unused, &report);
  return report;
}

}  // namespace springtower
