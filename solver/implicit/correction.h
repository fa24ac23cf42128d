#pragma once

namespace springtower {

struct IslandStep;
struct NewtonSystem;

/// The correction (island.direction) that takes island.residual away, with the factors at hand and, where the contacts `differ`
/// from what these know, with their tangents, but for forces of `allowed` weights of the lightest block. Returns false where they
/// differ too much for that. Precondition: island.factorised.
bool findCorrection(IslandStep& step, NewtonSystem& island, double effective_s, double allowed, bool differ);

/// Work of the present residual along the correction, J.
double directionalDerivative(const NewtonSystem& island);

}  // namespace springtower
