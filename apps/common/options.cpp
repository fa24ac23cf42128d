#include "apps/common/options.h"

#include "core/error.h"

#include <CLI/CLI.hpp>
#include <charconv>
#include <cmath>
#include <fmt/format.h>
#include <oneapi/tbb/info.h>
#include <string>

namespace springtower {
namespace {

template <class T>
std::optional<T> parsed(std::string_view text) {
  T value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size()) return {};
  return value;
}

Range settingRange(std::string_view key) {
  for (const SettingRow& row : settingTable()) {
    if (row.key == key) return {row.least, row.most, row.unit};
  }
  throw std::logic_error("no such setting: " + std::string(key));
}

CLI::Validator numberIn(const Range& range) {
  return {[range](std::string& text) -> std::string {
            const std::optional<double> value = parseNumber(text);
            if (value && *value >= range.least && *value <= range.most) return {};
            return fmt::format("expected a number from {}, got {}", describe(range), inQuotes(text));
          },
          ""};
}

// Also spells the number without leading zeros, by which the library would take it for an octal one.
CLI::Validator wholeNumberIn(const Range& range) {
  return {[range](std::string& text) -> std::string {
            const std::optional<std::int64_t> value = parsed<std::int64_t>(text);
            if (value && static_cast<double>(*value) >= range.least && static_cast<double>(*value) <= range.most) {
              text = std::to_string(*value);
              return {};
            }
            return fmt::format("expected a whole number from {}, got {}", describe(range), inQuotes(text));
          },
          ""};
}

}  // namespace

std::optional<double> parseNumber(std::string_view text) {
  const std::optional<double> value = parsed<double>(text);
  return value && std::isfinite(*value) ? value : std::nullopt;
}

CLI::Option* addNumber(CLI::App& app, const std::string& name, std::optional<double>& target, const Range& range,
                       const std::string& typeName, const std::string& description) {
  return app.add_option(name, target, fmt::format("{}; {}", description, describe(range)))
      ->type_name(typeName)
      ->check(numberIn(range));
}

CLI::Option* addWholeNumber(CLI::App& app, const std::string& name, std::optional<std::int64_t>& target, const Range& range,
                            const std::string& description) {
  return app.add_option(name, target, fmt::format("{}; {}", description, describe(range)))
      ->type_name("N")
      ->transform(wholeNumberIn(range));
}

void addFormerFlag(CLI::App& app, const std::string& former, CLI::Option* flag, bool& target) {
  // A group without a name would hide it, also from the message that refuses both.
  CLI::Option* alias = app.add_flag(former, target, "now " + flag->get_name())->group("Former names");
  for (CLI::Option* other : flag->get_excludes()) alias->excludes(other);
  alias->excludes(flag);
  flag->description(fmt::format("{}; formerly {}", flag->get_description(), former));
}

void addPhysicsOptions(CLI::App& app, PhysicsOptions& options) {
  app.add_option("--method", options.method,
                 "how a frame is stepped: implicit (default; also: bdf2), implicit-euler, implicit-eigen (also: bdf2-eigen; with "
                 "Eigen's sparse factors, for comparison), semi-implicit-euler, midpoint, runge-kutta-4, "
                 "report (also: legacy-2003; the impulses of the 2003 report, for comparison), or rigid blocks: rigid-pgs "
                 "(sequential impulses), "
                 "rigid-lcp (pivoting), xpbd (position-based); or auto, which takes the one that suits the scene")
      ->type_name("NAME");
  app.add_option("--inertia", options.inertia,
                 "how corners carry the mass: cuboid (default, a uniform cuboid's) or lumped (eight equal masses)")
      ->type_name("NAME");
  addNumber(app, "--tolerance", options.tolerance_m, settingRange("tolerance_m"), "METRES",
            "target penetration: no resting overlap and no compression of a row exceeds it; sets stiffness, and so the substeps "
            "(default 5e-05)");
  addWholeNumber(
      app, "--substeps", options.substeps, settingRange("substeps"),
      "substeps of a frame; alone, with explicit methods, the tolerance follows from them and is printed; implicit and "
      "rigid methods are stable with any");
  addWholeNumber(app, "--iterations", options.iterations, settingRange("iterations"),
                 "rigid methods: iterations over the contacts in a substep (default 1)");
  app.add_flag("--no-sleep", options.noSleep, "simulate blocks at rest like all others");
  CLI::Option* allowUnstable =
      app.add_flag("--allow-unstable", options.allowUnstable, "allow a tolerance and substeps that do not fit together");
  addFormerFlag(app, "--force-unstable", allowUnstable, options.allowUnstable);
  addWholeNumber(app, "--threads", options.threads, kThreadsRange,
                 "threads to use (default: one for each processor); the results are the same for any number");
}

void wrapDescriptions(CLI::App& app) {
  constexpr std::size_t kWidth = 84;
  for (CLI::Option* option : app.get_options()) {
    std::string text = option->get_description();
    for (std::size_t start = 0; text.size() - start > kWidth;) {
      const std::size_t space = text.rfind(' ', start + kWidth);
      if (space == std::string::npos || space <= start) break;
      text[space] = '\n';
      start = space + 1;
    }
    option->description(text);
  }
}

void applyPhysicsOptions(const PhysicsOptions& options, Settings& settings) {
  if (options.method) settings.method = methodFromName(*options.method, "--method");
  if (options.inertia) settings.inertia = inertiaFromName(*options.inertia, "--inertia");
  if (options.tolerance_m) settings.tolerance_m = options.tolerance_m;
  if (options.substeps) settings.substeps = static_cast<int>(*options.substeps);
  if (options.iterations) settings.iterations = static_cast<int>(*options.iterations);
  if (options.noSleep) settings.sleep = Sleep::off;
  if (options.allowUnstable) settings.allowUnstable = true;
}

int threadCount(const PhysicsOptions& options) {
  return options.threads ? static_cast<int>(*options.threads) : tbb::info::default_concurrency();
}

}  // namespace springtower
