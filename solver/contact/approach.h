#pragma once

#include "solver/world/island_step.h"

namespace springtower {

/// Speed of a block's fastest corner against a velocity, m/s.
double fastestCorner(const ParticleArray& velocity, std::size_t block, const Vec3& against);

/// What may meet in an island during this frame, from the speeds at its begin: the largest over its pairs of each number.
struct ApproachEstimate {
  double speed = 0.0;          ///< m/s at which the blocks of a pair may meet
  double reducedMass = 0.0;    ///< kg
  double cornerInverse = 0.0;  ///< 1/kg, the inverse mass of two corners against each other
  bool meeting = false;        ///< whether blocks that are apart may meet at all
  int together = 0;            ///< most pairs of any one block that may begin to push: hit at once they add up
};
ApproachEstimate estimateApproach(const IslandStep& step);

/// Whether a contact opens or closes as a whole, by more than an implicit step of `step_s` follows: in the midst of a bounce an
/// implicit step throws a block back with more than it came with.
bool bounces(const IslandStep& step, double step_s);

/// Whether blocks of the island that are apart come together within the frame, as they move now, at a speed that an implicit
/// step of `step_s` does not follow.
bool meetsSoon(const IslandStep& step, double step_s);

/// What has met in an implicit step: nothing that matters; blocks that have come to overlap as the step knew of no contact
/// between them; blocks, or points of a contact that did not push, at a speed that takes stiffer contacts than implicit steps
/// have.
enum class FirstContact { none, added, impact };

/// Looks for meetings in the implicit step just found. What the step began with does not tell: a hand may turn its block round
/// within one. Blocks that overlap are given their manifolds; the step is then to be solved again with them, from its start.
/// Precondition: the trial points are those of the step's end.
FirstContact meetingsIn(IslandStep& step);

}  // namespace springtower
