#pragma once

namespace springtower {

struct IslandStep;
struct NewtonSystem;

/// Computes the Newton direction (island.direction) for island.residual with the present factors and, where the contacts `differ`
/// from those in the factors, with their tangents. `residual`: largest of a block, in tuning::kNewtonResidual; the larger it is,
/// the more GMRES may leave of it. Returns false if GMRES leaves more. Precondition: island.factorised.
bool findCorrection(IslandStep& step, NewtonSystem& island, double effective_s, double residual, bool differ);

/// Directional derivative: the residual times the Newton direction, J.
double directionalDerivative(const IslandStep& step, const NewtonSystem& island);

}  // namespace springtower
