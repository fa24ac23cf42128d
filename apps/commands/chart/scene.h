#pragma once

#include "apps/commands/chart/chart.h"
#include "core/scene/scene.h"
#include "solver/world/simulation.h"

#include <optional>
#include <vector>

namespace springtower {

/// The tolerance, m, at which the method `auto` is compared with the others.
inline constexpr double kAutoTolerance_m = 5e-5;

/// The scene of a case, awake throughout. Throws InputError for rows that are not allowed.
Scene sceneOf(const ChartCase& what, const ChartLimits& limits);

/// All cases of a scene for these methods and other engines, each with its own parameter; fewer of them if `quick`.
std::vector<ChartCase> casesOf(ChartScene scene, const std::vector<Method>& methods, const std::vector<Peer>& peers, bool quick);

/// When, in s of simulated time: the state is kept that samples start from, resting figures begin, and all ends.
struct ChartTimes {
  double keep_s;
  double from_s;
  double end_s;
};
ChartTimes timesOf(ChartScene scene, const ChartLimits& limits);

/// Rows of a scene that is a tower of full rows, else 0.
int towerRows(ChartScene scene, const ChartLimits& limits);

/// Whether the blocks have to stand at the end; empty for blocks that are no stack, and for a tower that is hit.
std::optional<bool> expectedToStand(ChartScene scene);

/// The block that is pulled in scene `pull`: the middle one of the middle row. -1 in other scenes.
int pulledBlock(ChartScene scene, const Scene& blocks);

/// A hand that pulls one block, as far as a force that holds for a frame can, at a steady speed (proportional and integral
/// control); engines without our hand (solver/hand/grip) take a force.
struct SteadyPull {
  int block = -1;  ///< -1: no block is pulled
  Vec3 direction = Vec3::UnitX();
  double held_n = 0.0;  ///< what the last frames have shown to be needed, N
};

/// Sets the hand's force in the scene for the coming frame.
void pull(SteadyPull& hand, Simulation& simulation);

}  // namespace springtower
