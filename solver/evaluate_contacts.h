#pragma once

#include "solver/island_step.h"

namespace springtower {

/// What contacts put on the island's blocks at engine.frames, moving as engine.motion, into engine.contactForce; their memory is
/// brought up to date. `kick_s`: for how long the forces act in a leapfrog step.
void evaluateContacts(IslandStep& step, double advance_s, double kick_s);

}  // namespace springtower
