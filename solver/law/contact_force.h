#pragma once

#include "narrowphase/manifold.h"
#include "solver/block/affine.h"

#include <array>

namespace springtower {

/// The law of a contact point, with its constants. In the normal direction a spring of stiffness k on the elastic depth e = depth
/// - rest depth, a Maxwell branch beside it, and a dashpot; never pulling. Tangentially a spring on the displacement from the
/// anchor with a dashpot, bounded by Coulomb's cone (Cundall & Strack 1979): what the cone does not carry slides and is
/// forgotten.
struct ContactLaw {
  double stiffness_n_m = 0.0;        ///< k between blocks, N/m
  double floorStiffness_n_m = 0.0;   ///< k on the floor, N/m
  double maxwellRatio = 0.0;         ///< stiffness of the Maxwell branch over k
  double maxwellTime_s = 1.0;        ///< its relaxation time, s
  double dampingTime_s = 0.0;        ///< dashpot over stiffness, s
  double tangentialRatio = 1.0;      ///< tangential stiffness over k
  double staticFriction = 0.0;       ///< Coulomb's coefficient while it sticks
  double kineticFriction = 0.0;      ///< and while it slides
  double impactPenetration_m = 1.0;  ///< depth aimed at in an impact; decides how much a new contact is stiffened
  double stiffeningTime_s = 1.0;     ///< s in which that stiffening fades
  double restDepthPerSlip =
      0.0;  ///< how much of the rest depth fades per length of slip; its work is paid by the slip's own friction
};

/// What changes from step to step.
struct ContactStep {
  double advance_s = 0.0;      ///< s by which the contact memory is behind the positions
  double maxStiffening = 1.0;  ///< most a contact that is born now may be stiffened
  /// Where a point that is reached now starts to push: at 1 from the depth it is found at, which adds no energy; at 0 from the
  /// surface, which an implicit step needs, as it looks at the step's end alone. Its dashpot then closes by its depth in the
  /// step.
  double bornRestDepth = 1.0;
  double kick_s = 0.0;  ///< s for which the force acts on the velocities of a leapfrog step; 0 in other steps
};

/// Forces of one manifold on its two blocks, as sums over their affine coordinates (solver/block/affine.h), N.
struct PairForce {
  AffineField upper;
  AffineField lower;
};

/// One block of a contact: its frame, how it moves, and the motion that carried it since the contact memory was last brought up
/// to date (in the multi-stage methods not that of the state).
struct ContactSide {
  const BlockFrame* frame = nullptr;  ///< null for the floor
  const AffineField* motion = nullptr;
  const AffineField* carried = nullptr;
};

/// How a manifold's points push now, for reports: one entry a point.
struct PointForces {
  std::array<double, kManifoldPoints> depth{};
  std::array<double, kManifoldPoints> normal{};
  std::array<std::array<double, 3>, kManifoldPoints> friction{};
  std::array<Vec3, kManifoldPoints> place;       ///< on upper
  std::array<Vec3, kManifoldPoints> lowerPlace;  ///< on lower: its foot
  Vec3 direction = Vec3::UnitZ();                ///< unit normal from lower to upper
};

/// Evaluates a manifold: advances a copy of what its points store by `step.advance_s` and returns the forces. The advanced points
/// go to `keep`, which may be the manifold's own rows, or null where they are not wanted. `reducedMass_kg` is that of the two
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
