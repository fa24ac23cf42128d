#include "apps/commands/validate/frames.h"

#include "apps/common/interruption.h"
#include "apps/common/prepare_or_end.h"

namespace springtower {

void stepFrameOrEnd(Simulation& simulation) {
  prepareOrEnd(simulation);
  stepFrame(simulation);
}

RunResult runSceneOrEnd(Simulation& simulation, RunOptions options) {
  options.shouldStop = interrupted;
  RunResult result = runScene(simulation, options);
  endIfInterrupted();
  return result;
}

}  // namespace springtower
