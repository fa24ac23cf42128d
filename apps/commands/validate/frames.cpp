#include "apps/commands/validate/frames.h"

#include "apps/common/interruption.h"
#include "solver/frame/prepare.h"

namespace springtower {

void stepFrameOrEnd(Simulation& simulation) {
  endIfInterrupted();
  prepare(simulation, {.goesOn = [](const PrepareProgress&) { return !interrupted(); }});
  endIfInterrupted();
  stepFrame(simulation);
}

RunResult runSceneOrEnd(Simulation& simulation, const RunOptions& options) {
  return runScene(simulation, options, [](const Simulation&) { endIfInterrupted(); });
}

}  // namespace springtower
