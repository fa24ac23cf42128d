#include "solver/island_step.h"

namespace springtower {
void stepReport(IslandStep& step) { stepSemiImplicitEuler(step); }
}  // namespace springtower
