#pragma once

#include <cstddef>

namespace springtower {

struct IslandStep;
struct NewtonSystem;

/// Largest number of GMRES directions for one correction before new factors cost less: six in a narrow island (drawing a block
/// takes two to four), up to thirty in a wide one, whose factors cost as much as that many solutions, and thirty without fill.
std::size_t mostDirections(const NewtonSystem& island);

/// `solveCoupled` has reached its tolerance where the residual (2-norm) is below one of these.
struct GmresTolerance {
  double relative;  ///< share of the right-hand side
  double absolute_n;
};

/// Solves for island.affine in place as `solve` does, but with the contacts of island.tangents: their differences to those in the
/// factors, and the coupling of friction to the normal force, which a symmetric matrix cannot represent. GMRES (Saad & Schultz
/// 1986), with the factors as right preconditioner, or those of Gauss-Seidel where the matrix is without fill, until the residual
/// is within `tolerance`. Returns false if the allowed number of directions does not reach that, because the contacts differ too
/// much from those in the factors; island.affine is then the best approximation. Precondition: island.factorised.
bool solveCoupled(IslandStep& step, NewtonSystem& island, const GmresTolerance& tolerance);

}  // namespace springtower
