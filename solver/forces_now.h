#pragma once

#include "solver/engine.h"

namespace springtower {

/// The contact law of a scene as it stands.
ContactLaw contactLaw(const Simulation& simulation);

/// How a manifold's points push now: its memory brought up to date on a copy. Zeros where it is apart.
PointForces forcesNow(const Simulation& simulation, const Manifold& manifold);

/// Their sum on the upper block, N.
Vec3 forceOnUpper(const Simulation& simulation, const Manifold& manifold);

}  // namespace springtower
