#pragma once

#include "core/ids.h"
#include "core/scene/scene.h"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace CLI {
class App;
}  // namespace CLI

namespace springtower {

/// Options of `springtower statics`. Empty options leave what the scene says.
struct StaticsCommand {
  std::string scene;  ///< as for `run`; or a .jsonl file or - for a list of towers
  std::optional<double> friction;
  std::optional<double> heightsSigma_m;
  std::optional<double> massSigma_kg;
  std::optional<std::int64_t> seed;
  std::optional<double> tilt_deg;
  std::optional<double> direction_deg;
  std::vector<std::string> remove;  ///< ROW:POSITION or a block's number
  std::vector<std::string> pull;    ///< BLOCK,AXIS: a block, as above, and +x, -x, ...
  bool noRemovals = false;
  bool contacts = false;
  bool check = false;
  bool keepGoing = false;  ///< of a list, after a bad line
  std::optional<std::string> report;
  std::optional<std::int64_t> threads;
};

/// Adds the command to the program.
CLI::App* defineStatics(CLI::App& program, StaticsCommand& command);

/// The block that a text names: ROW:POSITION of a tower (rows from 0, positions from 1), or its number, counted from 0. Throws
/// InputError naming `option`, what is expected and what it got.
BlockId blockNamed(const Scene& scene, const std::string& text, const std::string& option);

/// Solves the equilibrium of a scene and prints a table, or that of all towers of a list, in parallel, and prints one JSON object
/// for each. Returns the exit code: 1 when `check` found a clear line that differs. Throws InputError.
int executeStatics(const StaticsCommand& command);

}  // namespace springtower
