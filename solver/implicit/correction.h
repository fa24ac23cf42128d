#pragma once

namespace springtower {

struct IslandStep;
struct NewtonSystem;

/// Computes the Newton direction (island.direction) for island.residual with the present factors and, where the contacts `differ`
/// from those in the factors, with their tangents, up to a residual of `allowed` weights of the lightest block. Returns false if
/// GMRES does not reach that. Precondition: island.factorised.
bool findCorrection(IslandStep& step, NewtonSystem& island, double effective_s, double allowed, bool differ);

/// Directional derivative: the residual times the Newton direction, J.
double directionalDerivative(const IslandStep& step, const NewtonSystem& island);

}  // namespace springtower
