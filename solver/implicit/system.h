#pragma once

#include "solver/block/affine.h"
#include "solver/world/newton_system.h"

namespace springtower {

struct IslandStep;

/// Sizes the working space of the iteration for a matrix that is laid out.
void layOutWork(NewtonSystem& island);

/// Lays out the matrix again where pairs have begun or ceased to touch, and sets island.exceedsFill where its fill is too large.
void layOut(IslandStep& step, NewtonSystem& island);

/// The hand's springs on the island's block, without the hand's position. `step_s` as in `assemble`.
TetherStiffness tetherStiffness(const IslandStep& step, double step_s);

/// Whether the hand is at a limit of its forces.
bool isTetherLimited(const IslandStep& step);

/// Assembles and factorises for contacts with the active set island.mask. `step_s` is the step times the method's factor. Returns
/// false where the matrix is not positive definite (without fill: a block of its diagonal).
bool assemble(IslandStep& step, NewtonSystem& island, double step_s);

/// In the search for an equilibrium: the next factors are of a matrix whose diagonal is stiffer by the next larger share than
/// that of the present ones, up to tuning::kMaxShortLineShare.
void stiffenDiagonal(IslandStep& step);

/// Solves for island.affine in place with the present factors: forces (N) in, displacements (m) out, in the world's frame, by
/// node. Precondition: island.factorised.
void solve(IslandStep& step, NewtonSystem& island);

}  // namespace springtower
