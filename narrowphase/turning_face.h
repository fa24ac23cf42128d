#pragma once

#include "narrowphase/crossing.h"

namespace springtower {

/// How far apart a direction keeps two blocks while it turns with one of them.
struct TurningGap {
  double least;      ///< m, no more than the gap at any time of the step, to the face's shrinking or growing meanwhile
  Vec3 normalAtEnd;  ///< unit, from b to a
};

/// The gap of two blocks along the normal of a face, through a step in which its edges move as its corners do: that of the face
/// of either block whose normal is nearest to `normal` at the start (unit, from b to a). The cross product of edges that move
/// linearly is quadratic in time and the height of a corner along it cubic: in Bernstein form it is never below its least
/// coefficient. Blocks that turn together are apart along such a direction where no fixed one separates them at both ends.
TurningGap gapAlongTurningFace(const Vec3& normal, const MovingBlock& a, const MovingBlock& b);

}  // namespace springtower
