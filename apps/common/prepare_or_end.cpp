#include "apps/common/prepare_or_end.h"

#include "apps/common/interruption.h"

namespace springtower {

PrepareResult prepareOrEnd(Simulation& simulation) {
  endIfInterrupted();
  const PrepareResult result = prepare(simulation, {.goesOn = [](const PrepareProgress&) { return !interrupted(); }});
  endIfInterrupted();
  return result;
}

}  // namespace springtower
