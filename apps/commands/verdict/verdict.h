#pragma once

#include "apps/common/options.h"
#include "core/scene/scene.h"

#include <iosfwd>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
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
  bool keepGoing = false;  ///< after a bad line
};

/// One line of the input: a tower to be simulated.
struct VerdictLine {
  std::size_t number = 0;  ///< of the line, from 1
  std::string id;
  Scene scene;
  nlohmann::ordered_json expect;  ///< carried along as it came; null without
};

/// Reads one line, a JSON object. `ids` are those of the lines before, to which its own is added. `where` begins messages. Throws
/// InputError saying what is expected and what it got: broken JSON, unknown or missing keys, keys that appear twice in an
/// object, values of a wrong type or outside their range, bit codes with a typo, ids that appear twice.
VerdictLine readVerdictLine(const std::string& text, std::size_t number, const std::string& where, std::set<std::string>& ids);

/// Reads all lines of an input; empty ones are skipped. `source` names the input in messages. Throws InputError as above, naming
/// the line.
std::vector<VerdictLine> readVerdictLines(std::istream& input, const std::string& source);

/// Whether a line is judged: its expectation is clear and says yes or no.
bool isClear(const VerdictLine& line);

/// Adds the command to the program.
CLI::App* defineVerdict(CLI::App& program, VerdictCommand& command);

/// Simulates all lines, in parallel, and prints one JSON object for each, in their order, as soon as it and those before it are
/// known. Returns the exit code: 1 when `check` found a clear line that differs, 3 when a scene diverged (its verdict is then
/// null, and the others are printed all the same), 2 when lines were bad and left out (`keepGoing`), and that of a signal when
/// one has come. Throws InputError for a bad line without `keepGoing`, when those before it are printed.
int executeVerdict(const VerdictCommand& command);

}  // namespace springtower
