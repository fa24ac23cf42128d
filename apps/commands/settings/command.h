#pragma once

namespace CLI {
class App;
}  // namespace CLI

namespace springtower {

/// Options of `springtower settings`.
struct SettingsCommand {
  bool all = false;   ///< the engine's own constants as well
  bool json = false;  ///< as JSON instead of a table
};

/// Adds the command to the program.
CLI::App* defineSettings(CLI::App& program, SettingsCommand& command);

/// Prints what a scene may set, with units, ranges and defaults; with `all` the engine's own constants, with the evidence they
/// rest on. Returns the exit code.
int executeSettings(const SettingsCommand& command);

}  // namespace springtower
