#pragma once

#include "solver/world/engine.h"

#include <cstdint>
#include <span>

namespace springtower {

/// Largest eigenvalue of M^-1 K (1/s2) of one free block with its springs alone: exact, by the 24 x 24 eigenvalue problem.
double blockSpectralRadius(const BlockModel& model, Inertia inertia, std::size_t block);

/// A bound of eigenvalues, 1/s2, and the block that is the stiffest for its mass.
struct SpectralBound {
  double radius = 0.0;
  std::int32_t block = 0;
};

/// Upper bound of the largest eigenvalue of M^-1 K (1/s2) of an island with its present springs and contacts; all points of a
/// manifold count as sticking, touching or not. It is the largest of the blocks' own spring radii plus twice the largest radius
/// of any one block against its contacts with its neighbours held: K of a contact is k (p - q)(p - q)^T <= 2 k (p p^T + q q^T)
/// for the weights p and q of its two blocks. The second part needs the affine part only, so it is a 4 x 4 problem a block. In a
/// tower the bound is within 8 % of the true value (the mode that presses every other block flat attains the factor two), without
/// iterations or stored state.
SpectralBound spectralBound(Simulation& simulation, std::span<const std::int32_t> blocks, std::span<const std::int32_t> pairs);

/// A signature that changes when an island's set of contacts or their stiffness does, to decide whether a bound is up to date.
std::uint64_t contactSignature(const Engine& engine, std::span<const std::int32_t> pairs);

}  // namespace springtower
