#pragma once

#include "solver/law/contact_force.h"
#include "solver/world/engine.h"
#include "solver/world/frame_part.h"

#include <cstdint>
#include <span>

namespace springtower {

class SearchMonitor;  // solver/implicit/search_monitor.h
struct RigidIsland;   // solver/world/rigid_island.h

/// One island during one frame or a part of it: what a method's step needs, and where it may write. Everything it writes belongs
/// to this island alone, so islands run in parallel.
struct IslandStep {
  Simulation& simulation;
  Engine& engine;
  std::span<const std::int32_t> blocks;
  std::span<const std::int32_t> pairs;  ///< positions in engine.pairs
  Counters& counters;
  StageTimes& times;
  ContactLaw law;
  FramePart part{};             ///< s, from where to where in the frame it is run now
  Vec3 gravity = Vec3::Zero();  ///< m/s2, at the time of the step
  double time_s = 0.0;          ///< s, start of the step
  double drift_s = 0.0;         ///< s, step of the positions
  double kick_s = 0.0;          ///< s; step of the velocities: mean of the last and this drift (leapfrog with changing steps)
  double pushedFrom_s = 0.0;    ///< s; user forces act in the step by their means from this time on,
  double pushedUntil_s = 0.0;   ///< s, up to this one
  double pushedBefore_s = 0.0;  ///< s; the step before, whose means BDF2 carries on, or 0: it does not
  bool twoStep = false;         ///< of implicit steps: BDF2, else implicit Euler
  double advance_s = 0.0;       ///< s by which what the contact points store lags behind the positions
  double maxStiffening = 1.0;   ///< upper bound of the stiffening of contacts made now
  /// Pairs that touch or may use up their clearance soon: all pairs, unless the steps are so short that a list of these pays.
  std::span<const std::int32_t> activePairs = pairs;
  bool usesActiveList = false;               ///< whether the steps are that short
  int activeListSteps = 0;                   ///< steps for which `activePairs` remains valid
  PointKind pointKind = PointKind::penalty;  ///< what the points of contacts made now store, by the kind of steps
  bool sticks = false;                       ///< points that push stick, where there is friction at all
  double smoothing_j = 0.0;                  ///< of ContactStep
  RigidIsland* rigid = nullptr;              ///< working data of its rigid steps while these run
  SearchMonitor* monitor = nullptr;          ///< of the search for the equilibrium, or null
  float diagonalShare = 0.0F;           ///< by which the search last made the diagonal of its factors stiffer; 0 in other steps
  bool falls = false;                   ///< whether its last step failed because a block moved too far
  bool leftBox = false;                 ///< whether the search for the equilibrium took a block out of its swept box
  std::span<const BlockPair> driven{};  ///< fixed blocks near it that drives move in this frame, as the second of each
  bool modeChanged = false;             ///< contacts have become springs or impulses since the part of the frame began
  bool withoutFill = false;             ///< a wide island's equations are solved without fill (solver/algebra/gauss_seidel.h)
  bool unforced = false;                ///< neither user forces nor the hand act: the equilibrium before the first frame
};

/// Result of an island's frame.
struct IslandOutcome {
  int substeps = 0;
  bool inside = true;     ///< no block left its swept box
  bool rebounds = false;  ///< whether blocks have met in rigid steps so fast that they rebound
};

}  // namespace springtower
