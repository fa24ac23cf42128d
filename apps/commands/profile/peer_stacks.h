#pragma once

#include "apps/commands/profile/profile.h"
#include "apps/common/peer_process.h"
#include "solver/world/simulation.h"

#include <functional>
#include <vector>

namespace springtower {

/// Runs another engine on the scene of a simulation, whose state does not matter, with ever more steps a frame, until it is no
/// deeper than `penetration_mm` (of ours) or more steps would exceed `limit_s` of processor time. Each run is of a simulated
/// second, or less where the stack falls or the time does not suffice. Empty where its program is not beside this one, or for a
/// limit of 0. `beforeRun` is called before each run. A run in which the engine fails is left out. Throws Interrupted.
std::vector<PeerFigures> measurePeer(Peer peer, const Simulation& simulation, double penetration_mm, double limit_s,
                                     const std::function<void()>& beforeRun);

}  // namespace springtower
