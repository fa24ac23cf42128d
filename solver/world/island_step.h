#pragma once

#include "solver/law/contact_force.h"
#include "solver/world/engine.h"

#include <span>

namespace springtower {

/// One island on its way through one frame: what a method's step needs, and where it may write. Everything it touches belongs to
/// the island alone, so islands run side by side.
struct IslandStep {
  Simulation& simulation;
  Engine& engine;
  std::span<const std::int32_t> blocks;
  std::span<const std::int32_t> pairs;  ///< positions in engine.pairs
  Counters& counters;
  StageTimes& times;
  ContactLaw law;
  Vec3 gravity = Vec3::Zero();  ///< m/s2, at the step's time
  double time_s = 0.0;          ///< s, start of the step
  double drift_s = 0.0;         ///< s; step of the positions
  double kick_s = 0.0;          ///< s; step of the velocities: mean of the last and this drift (leapfrog with changing steps)
  double advance_s = 0.0;       ///< s by which the contact memory is behind the positions
  double maxStiffening = 1.0;   ///< most a contact that is born now may be stiffened
  /// Pairs that touch or may use up their margin soon: all, but in steps so short that it is worth listing them.
  std::span<const std::int32_t> activePairs = pairs;
  bool usesActiveList = false;               ///< whether the steps are so short
  int activeListSteps = 0;                   ///< steps for which `activePairs` still holds
  PointKind pointKind = PointKind::penalty;  ///< what contacts that are made now store, by the steps that carry the island
  bool unforced = false;                     ///< neither user forces nor the hand act: the equilibrium before the first frame
};

/// What came of an island's frame.
struct IslandOutcome {
  int substeps = 0;
  bool inside = true;  ///< no block left its swept box
};

}  // namespace springtower
