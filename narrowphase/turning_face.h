#pragma once

#include "narrowphase/crossing.h"

namespace springtower {

/// Gap of two blocks along a direction that rotates with one of them.
struct TurningGap {
  double least;      ///< m, lower bound of the gap over the step, up to the change of the face's size in it
  Vec3 normalAtEnd;  ///< unit, from b to a
};

/// The gap of two blocks along the normal of a face, through a step in which its edges move as its corners do: the face of either
/// block whose normal is nearest to `normal` at the start (unit, from b to a). The cross product of edges that move linearly is
/// quadratic in time, and the height of a corner along it cubic: in Bernstein form it is never below its least coefficient.
/// Blocks that rotate together are separated along such a direction where no fixed one separates them at both ends.
TurningGap gapAlongTurningFace(const Vec3& normal, const MovingBlock& a, const MovingBlock& b);

}  // namespace springtower
