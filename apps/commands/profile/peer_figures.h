#pragma once

#include "apps/commands/profile/profile.h"
#include "apps/common/peer_process.h"
#include "solver/world/simulation.h"

#include <functional>
#include <vector>

namespace springtower {

/// How long another engine is looked at, and how good it must get.
struct PeerRun {
  int fallFrames = 0;  ///< of a fall, from its start on; 0 for a stack, which is looked at for a second or until it falls
  double penetration_mm = 0.0;  ///< ours: no more steps are tried once it is no deeper
  double limit_s = 0.0;         ///< of processor time, for all its settings; 0: none is run
};

/// Runs another engine on the scene of a simulation, whose state does not matter, with ever more steps a frame, until it is no
/// deeper than ours or more steps would exceed the time. A run that takes too long ends early. Empty where its program is not
/// beside this one. `beforeRun` is called before each run. A run in which the engine fails is left out. Throws Interrupted.
std::vector<PeerFigures> measurePeer(Peer peer, const Simulation& simulation, const PeerRun& run,
                                     const std::function<void()>& beforeRun);

}  // namespace springtower
