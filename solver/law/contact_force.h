#pragma once

#include "core/scene/friction.h"
#include "narrowphase/manifold.h"
#include "solver/block/affine.h"
#include "solver/law/block_stiffness.h"

#include <array>
#include <cstdint>

namespace springtower {

/// The contact law of a point, with its constants. In the normal direction a spring of stiffness k on the elastic depth e = depth
/// - rest depth, a Maxwell branch in parallel, and a dashpot; the sum never pulls. Tangentially a spring on the displacement from
/// the anchor with a dashpot, bounded by Coulomb's cone (Cundall & Strack 1979): displacement beyond the cone is slip and is
/// dropped. The cone is that of static friction unless all points of the contact slip together.
struct ContactLaw {
  const BlockStiffness* stiffness = nullptr;  ///< k of each pair, N/m
  double maxwellRatio = 0.0;                  ///< stiffness of the Maxwell branch over k
  double maxwellTime_s = 1.0;                 ///< its relaxation time, s
  double dampingTime_s = 0.0;                 ///< dashpot over stiffness, s
  double tangentialRatio = 1.0;               ///< tangential stiffness over k
  const FrictionTable* friction = nullptr;    ///< Coulomb's coefficients: static while any point of a contact sticks
  double impactPenetration_m = 1.0;           ///< target depth of an impact; determines the stiffening of a new contact
  double stiffeningTime_s = 1.0;              ///< s, time constant with which that stiffening fades
  double restDepthPerSlip = 0.0;              ///< rest depth that fades per length of slip, over kinetic friction

  /// k of a pair's points, N/m; `lower` is negative for the floor.
  [[nodiscard]] double stiffnessOf(std::int32_t upper, std::int32_t lower) const {
    return pairStiffness(*stiffness, upper, lower);
  }
  /// Coulomb's coefficient of a contact as it is: that of all its points.
  [[nodiscard]] double frictionOf(const ManifoldShape& contact) const {
    const Friction of = friction->of(contact.upper, contact.lower);
    return contact.slips ? of.kineticFriction : of.staticFriction;
  }
};

/// Parameters that change from step to step.
struct ContactStep {
  double advance_s = 0.0;      ///< s by which what the contact points store lags behind the positions
  double maxStiffening = 1.0;  ///< upper bound of the stiffening of a contact made now
  /// Whether forces are those at the step's end alone, as in implicit steps. Then the spring of a point that makes contact starts
  /// at the surface, and damping velocities are limited to elastic depth over step; otherwise it starts unloaded at the depth
  /// where it is detected, which adds no energy.
  bool endOnly = false;
  bool sticks = false;  ///< whether points that push stick, where there is friction at all
  double kick_s = 0.0;  ///< s for which the force acts on the velocities of a leapfrog step; 0 in other steps
  /// J, of smoothed contacts, in the search for an equilibrium: every point, also across a gap, has the normal force N > 0 with
  /// N (N / k - depth) equal to this (Chen & Harker 1993). 0: contacts as they are.
  double smoothing_j = 0.0;
};

/// Forces of one manifold on its two blocks, as sums over their affine coordinates (solver/block/affine.h), N.
struct PairForce {
  AffineField upper;
  AffineField lower;
};

/// One block of a contact: its frame, its motion, and the motion that moved it since its contact points were last advanced (in
/// the multi-stage methods not that of the state).
struct ContactSide {
  const BlockFrame* frame = nullptr;  ///< null for the floor
  const AffineField* motion = nullptr;
  const AffineField* carried = nullptr;
};

/// Forces of a manifold's points, for reports: one entry a point.
struct PointForces {
  std::array<double, kManifoldPoints> depth{};
  std::array<double, kManifoldPoints> normal{};
  std::array<std::array<double, 3>, kManifoldPoints> friction{};
  std::array<Vec3, kManifoldPoints> place;       ///< on upper
  std::array<Vec3, kManifoldPoints> lowerPlace;  ///< on lower: the foot of the point
  /// Of a contact that slips: where the friction of each point acts. `friction` is what acts at the points to the same effect.
  std::array<Vec3, kManifoldPoints> slipPlace;
  std::array<Vec3, kManifoldPoints> lowerSlipPlace;
  Vec3 direction = Vec3::UnitZ();  ///< unit normal from lower to upper
};

/// Evaluates a manifold: advances a copy of its points by `step.advance_s` and returns the forces. The advanced points are
/// written to `keep`, which may be the manifold's own rows, or null if they are not needed. `reducedMass_kg` is that of the two
/// blocks. Precondition: the manifold is of penalty points.
void manifoldForces(const ContactView& manifold, const ContactSide& upper, const ContactSide& lower, const ContactLaw& law,
                    const ContactStep& step, double reducedMass_kg, const PointRows* keep, PairForce& result);

/// The same for reports: evaluates without advancing or keeping anything.
PointForces pointForces(const ContactView& manifold, const ContactSide& upper, const ContactSide& lower, const ContactLaw& law);

/// Adds one affine field of forces to another.
inline void addForce(const AffineField& part, AffineField& sum) {
  for (std::size_t k = 0; k < 3; ++k) {
    sum.centre[k] += part.centre[k];
    for (std::size_t a = 0; a < 3; ++a) sum.side[a][k] += part.side[a][k];
  }
}

}  // namespace springtower
