#pragma once

#include "solver/world/island_step.h"

namespace springtower {

/// Before the first frame: moves an island whose blocks all touch and do not move into the static equilibrium next to its initial
/// placement. Blocks as placed would carry no contact forces and drop by about the tolerance, and that impact topples what stands
/// by less. User forces do not act yet. The equilibrium is found by implicit Euler steps without inertial history, so long that
/// inertia is negligible: first as if nothing slipped, or else with smoothed contacts (solver/implicit/smoothing.h), then with
/// friction, in short steps where much slips. An island that falls under tilted gravity is put into an equilibrium at nearly the
/// largest share of the tilt at which it stands. If there is none nearby, everything is left as placed. Precondition: contacts
/// are found. Returns whether the island is in equilibrium.
bool startInEquilibrium(IslandStep& step);

/// Where forces begin to act at the start of the frame on an island that rests, moves it into equilibrium with them, if there is
/// one within its springs' strain: friction and the weight of rigid blocks hold a force without motion, but springs that are
/// struck would swing to twice its size, and what is held would slip. Returns whether it has; everything is as before where not.
/// Precondition: no step of the frame has been taken.
bool followNewForces(IslandStep& step);

}  // namespace springtower
