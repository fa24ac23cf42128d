#pragma once

#include "solver/runner/run.h"

#include <nlohmann/json_fwd.hpp>

namespace springtower {

/// All figures of a run under the names of docs/reports.md; what the run was too short for is null.
nlohmann::ordered_json reportJson(const Simulation& simulation, const RunResult& result, int threads);

/// Prints the figures people look for first as a table on standard output.
void printResult(const Simulation& simulation, const RunResult& result, int threads);

}  // namespace springtower
