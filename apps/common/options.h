#pragma once

#include "core/limits.h"
#include "core/settings.h"

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace springtower {

inline constexpr Range kThreadsRange{1, 1024, ""};
inline constexpr Range kSeedRange{0.0, 9007199254740992.0, ""};  ///< up to where every whole number is a double

/// Options of how to simulate, the same for every command that simulates. Empty ones leave what the scene says.
struct PhysicsOptions {
  std::optional<std::string> method;
  std::optional<std::string> inertia;
  std::optional<double> tolerance_m;
  std::optional<std::int64_t> substeps;
  std::optional<std::int64_t> iterations;
  bool noSleep = false;
  bool allowUnstable = false;
  std::optional<std::int64_t> threads;
};

/// Adds an option that takes a finite number inside a range; anything else is refused with the range.
CLI::Option* addNumber(CLI::App& app, const std::string& name, std::optional<double>& target, const Range& range,
                       const std::string& typeName, const std::string& description);

/// The same for whole numbers; the range's unit is not used.
CLI::Option* addWholeNumber(CLI::App& app, const std::string& name, std::optional<std::int64_t>& target, const Range& range,
                            const std::string& description);

/// Lets a flag be given by a former name as well: by either, not by both. The help shows the former name in the description of
/// the flag, and once more at its end. Call it once the flag has all that it excludes.
void addFormerFlag(CLI::App& app, const std::string& former, CLI::Option* flag, bool& target);

/// Adds the options of `PhysicsOptions` to a command.
void addPhysicsOptions(CLI::App& app, PhysicsOptions& options);

/// Breaks the descriptions of all options of a command into lines that fit beside their names. Call it last.
void wrapDescriptions(CLI::App& app);

/// Puts what was given over a scene's settings. Throws InputError for an unknown method or inertia.
void applyPhysicsOptions(const PhysicsOptions& options, Settings& settings);

/// Threads to use: as given, or one for each processor the program may run on.
int threadCount(const PhysicsOptions& options);

/// A finite number, written in full; empty for anything else.
std::optional<double> parseNumber(std::string_view text);

}  // namespace springtower
