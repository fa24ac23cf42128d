#pragma once

#include "solver/frame/prepare.h"

namespace springtower {

/// As prepare, but a signal ends the search (apps/common/interruption.h): throws Interrupted then, and before it where one has
/// come.
PrepareResult prepareOrEnd(Simulation& simulation);

}  // namespace springtower
