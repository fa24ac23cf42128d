#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace CLI {
class App;
}  // namespace CLI

namespace springtower {

/// Options of `springtower chart`.
struct ChartCommand {
  std::vector<std::string> scenes;
  std::vector<std::string> methods;
  std::optional<std::int64_t> rows;
  std::optional<double> seconds;
  std::optional<double> case_s;
  std::optional<std::int64_t> samples;
  std::vector<std::string> peers;
  std::string out = "chart";
  bool quick = false;
  bool unlimited = false;
  bool maps = false;
  bool automatic = false;
  bool fresh = false;
};

/// Adds the command to the program.
CLI::App* defineChart(CLI::App& program, ChartCommand& command);

/// Measures every case, scene by scene, and writes chart.json, chart.csv, the charts and index.md into the folder of `--out`.
/// What an earlier run with the same build and limits has left there is not measured again, what another has left is refused
/// unless `--no-resume`, and so is what a build with uncommitted changes has left, or is to go on with. With `--maps` stability
/// maps instead: maps.csv, the maps and maps.md. Returns the exit code 0. Throws InputError.
int executeChart(const ChartCommand& command);

}  // namespace springtower
