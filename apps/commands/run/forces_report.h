#pragma once

#include "solver/world/simulation.h"

#include <nlohmann/json_fwd.hpp>

namespace springtower {

/// All forces on all blocks as they are now, complete enough to add them up again: gravity, pushes of the user, and every contact
/// point that carries something, with the place where it acts on either block. A block's sum is its own rate of change of
/// momentum, zero at rest, and stands beside it (solver/metrics/balance.h); torques are about its centre. Newtons and metres.
nlohmann::ordered_json forcesJson(const Simulation& simulation);

}  // namespace springtower
