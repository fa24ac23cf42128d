#pragma once

#include "apps/commands/profile/profile.h"
#include "core/scene/scene.h"
#include "scenarios/recorded/recording.h"
#include "solver/hand/grip.h"
#include "solver/world/simulation.h"

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace springtower {

/// The scene of a case. Throws InputError for a tower that is not allowed.
Scene sceneOf(const ProfileCase& what);

/// A simulation on the brink of what is to be timed, and the state to come back to before each sample.
struct PreparedScene {
  explicit PreparedScene(const ProfileCase& what) : simulation(sceneOf(what)) {}

  Simulation simulation;
  Draw hand;                           ///< that pulls a block; it holds none in other scenes
  const Recording* game = nullptr;     ///< whose hand acts, from the first frame on; null in other scenes
  Grip grip;                           ///< of that hand
  std::vector<ContactForce> contacts;  ///< of a game, at the present state
  std::shared_ptr<const Snapshot> snapshot;
  Draw handKept;                      ///< the hand of the snapshot
  std::vector<std::uint8_t> leftOut;  ///< 1 for blocks that need not stand: the pulled one, what falls; [blocks] or empty
  double equilibrium_s = 0.0;         ///< processor time of the search for a stack's equilibrium, s
  std::string failure;                ///< why the scene does not come to what is to be timed; empty when it does

  /// Back to the kept state.
  void restore();
  /// One frame, the hand included.
  void step();
};

/// Runs a new scene up to what is to be timed and keeps its state: settles it, starts to pull, or lets it fall asleep. Divergence
/// ends in `failure`.
std::unique_ptr<PreparedScene> prepareScene(const ProfileCase& what, const ProfileLimits& limits);

}  // namespace springtower
