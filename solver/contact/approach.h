#pragma once

#include "solver/world/island_step.h"

namespace springtower {

/// Speed of a block's fastest corner relative to a velocity, m/s.
double fastestCorner(const ParticleArray& velocity, std::size_t block, const Vec3& against);

/// Possible first contacts of an island in this frame, from the speeds at its start: the largest over its pairs of each number.
struct ApproachEstimate {
  double stiffening = 0.0;  ///< factor on the resting stiffness at which the impact stops within the target depth
  double pointRate = 0.0;   ///< 1/s2, largest eigenvalue of M^-1 K that one new contact point of resting stiffness adds
  bool meeting = false;     ///< whether separated blocks may touch at all
  int together = 0;         ///< number of pairs of one block that may make first contact; simultaneous ones add up
};
ApproachEstimate estimateApproach(const IslandStep& step);

/// Whether all active points of any contact open or close faster than an implicit step of `step_s` resolves. An implicit step
/// across a rebound would return the block with more energy than it had.
bool bounces(const IslandStep& step, double step_s);

/// Whether separated blocks of the island will touch within the frame at their present velocities, at a closing speed that an
/// implicit step of `step_s` does not resolve.
bool isAboutToCollide(const IslandStep& step, double step_s);

/// Whether separated blocks of the island will touch before long so fast that they rebound.
bool isAboutToRebound(const IslandStep& step);

/// First contacts of an implicit step. none: none that matters. added: blocks without a known contact overlap at its end. impact:
/// blocks, or points of a contact without force, closed at a speed that requires stiffer contacts than implicit steps have.
enum class FirstContact { none, added, impact };

/// Looks for first contacts in the implicit step just computed. The start of the step is not sufficient for this: within a step a
/// hand may change the direction of its block. Overlapping blocks get their manifolds; the step then has to be solved on with
/// them. Precondition: the trial points are those of the step's end.
FirstContact findFirstContacts(IslandStep& step);

}  // namespace springtower
