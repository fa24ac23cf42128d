#pragma once

#include "apps/common/options.h"
#include "core/scene/scene.h"

#include <iosfwd>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

namespace CLI {
class App;
}  // namespace CLI

namespace springtower {

/// Options of `springtower verdict`.
struct VerdictCommand {
  std::string file;  ///< - for standard input
  std::optional<double> seconds;
  PhysicsOptions physics;
  bool check = false;
};

/// One line of the input: a tower to be simulated.
struct VerdictLine {
  std::size_t number = 0;  ///< of the line, from 1
  std::string id;
  Scene scene;
  nlohmann::ordered_json expect;  ///< carried along as it came; null without
};

/// Reads JSON objects, one a line; empty lines are skipped. `source` names the input in messages. Throws InputError naming the
/// line, what was found and what is allowed: broken JSON, unknown or missing keys, keys that appear twice in an object, values of
/// a wrong type or outside their range, bit codes with a typo, ids that appear twice.
std::vector<VerdictLine> readVerdictLines(std::istream& input, const std::string& source);

/// Whether a line is judged: its expectation is clear and says yes or no.
bool isClear(const VerdictLine& line);

/// Adds the command to the program.
CLI::App* defineVerdict(CLI::App& program, VerdictCommand& command);

/// Simulates all lines, in parallel, and prints one JSON object for each, in their order. Returns the exit code: 1 when `check`
/// found a clear line that differs, 3 when a scene diverged (its verdict is then null, and the others are printed all the same).
/// Throws InputError before anything is simulated or printed.
int executeVerdict(const VerdictCommand& command);

}  // namespace springtower
