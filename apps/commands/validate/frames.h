#pragma once

#include "solver/runner/run.h"

namespace springtower {

/// As stepFrame, but throws Interrupted (apps/common/interruption.h) once a signal has come.
void stepFrameOrEnd(Simulation& simulation);

/// As runScene; throws Interrupted with the frame after a signal has come.
RunResult runSceneOrEnd(Simulation& simulation, const RunOptions& options);

}  // namespace springtower
