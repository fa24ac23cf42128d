#include "solver/reference/report_frame.h"

#include "solver/contact/update.h"
#include "solver/sleep/rest.h"

namespace springtower {

void prepareReportFrame(Simulation& simulation) {
  ReportState& report = simulation.engine->report;
  report.testedAt.assign(simulation.engine->pairs.size(), {});
}

void rewindReportFrame(Simulation& simulation) {
  ReportState& report = simulation.engine->report;
  for (std::vector<std::int32_t>& struck : report.struck) {
    for (const std::int32_t block : struck) wake(simulation, static_cast<std::size_t>(block), WakeReason::reportedImpact);
    struck.clear();
  }
}

bool acceptReportStep(IslandStep& step) {
  bool struck = false;
  for (const std::int32_t block : step.blocks)
    struck = struck || !step.engine.report.struck[static_cast<std::size_t>(block)].empty();
  return addTravel(step) && !struck;
}

}  // namespace springtower
