#pragma once

#include "solver/runner/run.h"

namespace springtower {

/// As stepFrame, but throws Interrupted (apps/common/interruption.h) once a signal has come.
void stepFrameOrEnd(Simulation& simulation);

/// As runScene; throws Interrupted once a signal has come, with the frame or in the search for the equilibrium. `shouldStop` of
/// the options is not called.
RunResult runSceneOrEnd(Simulation& simulation, RunOptions options);

}  // namespace springtower
