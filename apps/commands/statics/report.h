#pragma once

#include "core/scene/scene.h"
#include "solver/statics/statics.h"

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

namespace springtower {

/// The greatest pull on a block: nothing for a scene that falls, infinite where nothing limits it.
struct PullAnswer {
  BlockId block = kFloor;
  std::string axis;
  std::optional<double> limit_n;
};

/// All that statics says of a scene; what was not computed or has no meaning for a scene that falls is empty.
struct StaticsAnswer {
  StaticScene statics;
  std::optional<StabilityMargin> margin;
  ContactLoads loads;
  std::vector<BlockLoad> blocks;
  std::vector<std::optional<Removal>> removals;  ///< nothing for those that a signal came before
  std::vector<PullAnswer> pulls;
  bool interrupted = false;  ///< by a signal, so that something is missing
  double wall_s = 0.0;
};

/// "stands", "stands after leaning" or "falls".
std::string_view nameOf(Rest rest);

/// Verdict and margin under the names that lists and reports share: stands, leans, tilt_deg, tilt_direction_deg.
nlohmann::ordered_json restJson(Rest rest, const std::optional<StabilityMargin>& margin);

/// All figures under the names of docs/reports.md.
nlohmann::ordered_json staticsJson(const Scene& scene, const StaticsAnswer& answer);

/// Prints the verdict and a table of the blocks on standard output, and with `contacts` one of the contacts.
void printStatics(const Scene& scene, const StaticsAnswer& answer, bool contacts);

}  // namespace springtower
