#pragma once

#include "apps/common/options.h"
#include "core/scene/scene.h"

#include <cstdint>
#include <optional>
#include <string>

namespace CLI {
class App;
}  // namespace CLI

namespace springtower {

/// Options of `springtower run`. Empty options leave what the scene says.
struct RunCommand {
  std::string scene;
  std::optional<double> seconds;
  PhysicsOptions physics;
  std::optional<double> heightsSigma_m;
  std::optional<double> massSigma_kg;
  std::optional<std::int64_t> seed;
  std::optional<double> startGap_m;
  std::optional<double> prepareBudget_s;
  std::optional<double> tilt_deg;
  std::optional<double> direction_deg;
  std::optional<std::string> sway;  ///< DEG:HZ
  std::optional<std::string> report;
  bool forces = false;  ///< in the report
  std::optional<std::string> poses;
  std::optional<double> posesEvery_s;
  std::optional<std::string> picture;
  std::optional<std::string> save;
  std::optional<std::string> resume;
};

/// Adds the command to the program.
CLI::App* defineRun(CLI::App& program, RunCommand& command);

/// The scene with what the command line says put over it. Throws InputError.
Scene sceneOf(const RunCommand& command);

/// Simulates a scene or goes on with a run that was saved, writes the files that are named and prints a table. Returns the exit
/// code; a signal ends the run with the next frame, of which all files are written, and the report says so. Throws InputError for
/// what is wrong with the input or the names of the files, before anything is simulated, and DivergenceError; poses up to then
/// are kept.
int executeRun(const RunCommand& command);

}  // namespace springtower
