#pragma once

#include "solver/island_step.h"

namespace springtower {

/// Steps that an island which falls takes a frame, and how stiff contacts born in it may be (step.bornMost_s2): as many as the
/// contacts it has ask for, all that one of its blocks may get at once at rest stiffness, or one as its hardest impact wants it.
int chooseFallSteps(IslandStep& step);

}  // namespace springtower
