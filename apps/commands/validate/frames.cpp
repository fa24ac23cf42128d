#include "apps/commands/validate/frames.h"

#include "apps/common/interruption.h"
#include "apps/common/prepare_or_end.h"

namespace springtower {

void stepFrameOrEnd(Simulation& simulation) {
  prepareOrEnd(simulation);
  stepFrame(simulation);
}

RunResult runSceneOrEnd(Simulation& simulation, const RunOptions& options) {
  return runScene(simulation, options, [](const Simulation&) { endIfInterrupted(); });
}

}  // namespace springtower
