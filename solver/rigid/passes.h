#pragma once

#include "solver/world/packed_points.h"
#include "solver/world/rigid_island.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace springtower {

// Passes of sequential impulses over packed points, colour by colour.

/// A soft constraint: `rate` is the share of the gap closed in a second; `mass` scales the impulse of a rigid constraint, and
/// `impulse` is the share of the accumulated impulse that is subtracted.
struct Softness {
  double rate = 0.0;
  double mass = 1.0;
  double impulse = 0.0;
};

/// Parameters common to all points in a pass.
struct Pass {
  double step_s;
  double most;            ///< m/s, largest push-out speed
  double rounding;        ///< m: faces placed flush overlap by less, or not at all
  Softness soft;          ///< of those that overlap
  bool push;              ///< true: overlapping blocks are pushed apart; false: the push-out is removed from the velocities
  double near;            ///< m, gap at the end of the step up to which a point is active
  bool reversed = false;  ///< a pass over the active points takes those of a pair in reverse
};

/// Adds the impulses with which the points start to the velocities.
void applyWarmStart(std::vector<BodyMotion>& bodies, const PackedPoints& packed);

/// A pass over all points, which finds those that are active. Returns the number of those that push or have pushed.
std::size_t solveAll(const Pass& pass, std::vector<BodyMotion>& bodies, PackedPoints& packed);

/// A pass over the active points. Returns by how much it has changed the approach at a point at most, m/s.
double solveActive(const Pass& pass, std::vector<BodyMotion>& bodies, PackedPoints& packed);

/// Notes that pass `number` through an impact (0: what meets in it) has changed a body's velocity: the pairs in which it is are
/// due in the next pass, and in this one where they come later. Preconditions: island.changed [bodies + 1] and `due` of both
/// packs [pairs] hold numbers of at most `number` + 1, and -1 where nothing has changed; listPairsOfBodies has been called.
void noteChange(std::int32_t body, int number, RigidIsland& island);

/// Pass `number` through an impact: over those points of which a body's velocity has changed since they were solved last, as
/// `changed` [bodies] has it; pairs without active points that it reaches become active. Changes of less than `enough` (m/s)
/// count as none. Returns the number of points solved.
std::size_t solveChanged(const Pass& pass, RigidIsland& island, PackedPoints& packed, int number, double enough);

}  // namespace springtower
