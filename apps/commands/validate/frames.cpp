#include "apps/commands/validate/frames.h"

#include "apps/common/interruption.h"

namespace springtower {

void stepFrameOrEnd(Simulation& simulation) {
  endIfInterrupted();
  stepFrame(simulation);
}

RunResult runSceneOrEnd(Simulation& simulation, const RunOptions& options) {
  return runScene(simulation, options, [](const Simulation&) { endIfInterrupted(); });
}

}  // namespace springtower
