#pragma once

#include <cstddef>

namespace springtower {

struct IslandStep;
struct NewtonSystem;

/// Directions that are tried for one correction before new factors cost less: six in a tower, where a drawn block takes two to
/// four; up to thirty in a wide island, whose factors cost as much as so many solutions.
std::size_t mostDirections(const NewtonSystem& island);

/// Solves for island.affine in place as `solve` does, but for the contacts as island.tangents has them: where these differ from
/// what the factors know, and where friction follows the normal force, which a symmetric matrix cannot hold. GMRES (Saad &
/// Schultz 1986), with the factors as preconditioner from the right, until the forces left over are within `allowed_n` (root of
/// the sum of squares, N) or 2/1000 of those asked for. Returns false where a few directions do not reach that: the contacts
/// are too far from what the factors know; island.affine is then the best of them. Precondition: island.factorised.
bool solveCoupled(IslandStep& step, NewtonSystem& island, double allowed_n);

}  // namespace springtower
