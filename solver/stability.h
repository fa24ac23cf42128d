#pragma once

#include "solver/engine.h"

#include <span>

namespace springtower {

/// Largest eigenvalue of M^-1 K (1/s2) of an island as its springs and contacts stand, by power iteration with the mass in force (the
/// Rayleigh quotient, from below; it starts from the mode found last, kept in engine.mode, so it follows a changing set of contacts in few
/// iterations). All points of a manifold count, touching or not, as both their normal and tangential springs do.
/// `iterations` >= 1. Deterministic; part of the state.
double spectralRadius(Simulation& simulation, std::span<const std::int32_t> blocks, std::span<const std::int32_t> pairs, int iterations);

/// The same for one free block alone, with springs only: exact, by the 24 x 24 eigenvalue problem.
double blockSpectralRadius(const BlockModel& model, Inertia inertia, std::size_t block);

/// A number that changes when an island's set of contacts does: what the last spectral radius was computed for.
std::uint64_t contactSignature(const Engine& engine, std::span<const std::int32_t> pairs);

/// Gives a block's part of engine.mode its first value: every mode is in it.
void seedMode(Engine& engine, std::size_t block);

}  // namespace springtower
