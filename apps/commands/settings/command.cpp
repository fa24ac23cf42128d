#include "apps/commands/settings/command.h"

#include "core/settings.h"
#include "core/tuning.h"

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <string>

namespace springtower {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::string_view kSettingsHelp =
    R"help(A scene file sets these in its [settings]; docs/scenes.md says what a scene file looks like. A renamed key may be
given by its former name. With --all follow the numbers that no scene sets: thresholds, caps and safety factors of the engine,
each with what it is for and what it rests on. Lengths are in h, the height of the scene's lowest block, speeds in sqrt(g h),
times in sqrt(h / g).

examples:
  springtower settings
  springtower settings --all
  springtower settings --all --json > settings.json)help";

std::string defaultOf(const SettingRow& row) {
  const std::optional<double> value = numberOf(Settings{}, row);
  return value ? fmt::format("{:.6g}", *value) : "by scene";
}

Json settingsJson() {
  Json rows = Json::array();
  for (const SettingRow& row : settingTable()) {
    const std::optional<double> value = numberOf(Settings{}, row);
    const std::string_view former = formerKeyOf(row.key);
    rows.push_back({{"key", row.key},
                    {"unit", row.unit},
                    {"default", value ? Json(*value) : Json(nullptr)},
                    {"least", row.least},
                    {"most", row.most},
                    {"what", row.reason},
                    {"formerly", former.empty() ? Json(nullptr) : Json(former)}});
  }
  return rows;
}

Json tuningJson() {
  Json rows = Json::array();
  for (const TuningRow& row : tuningTable()) {
    rows.push_back({{"group", row.group},
                    {"name", row.name},
                    {"value", row.value},
                    {"expression", row.expression},
                    {"unit", row.unit},
                    {"purpose", row.purpose},
                    {"evidence", row.evidence}});
  }
  return rows;
}

void printSettings() {
  fmt::print("{:<26} {:>10}  {:<24} {:<14} {}\n", "key", "default", "allowed", "unit", "what");
  for (const SettingRow& row : settingTable()) {
    const std::string_view former = formerKeyOf(row.key);
    fmt::print("{:<26} {:>10}  {:<24} {:<14} {}{}\n", row.key, defaultOf(row), fmt::format("{:g} to {:g}", row.least, row.most),
               row.unit, row.reason, former.empty() ? "" : fmt::format("; formerly {}", former));
  }
}

void printTuning() {
  std::string_view group;
  for (const TuningRow& row : tuningTable()) {
    if (row.group != group) fmt::print("\n{}\n", row.group);
    group = row.group;
    fmt::print("  {:<28} {:>12.6g} {:<20} {}\n", row.name, row.value, row.unit, row.purpose);
    fmt::print("  {:<28} {:>12} {:<20} evidence: {}\n", "", "", "", row.evidence);
  }
}

}  // namespace

CLI::App* defineSettings(CLI::App& program, SettingsCommand& command) {
  CLI::App* app = program.add_subcommand("settings", "lists what a scene may set, and with --all the engine's own constants");
  app->footer(std::string(kSettingsHelp));
  app->add_flag("--all", command.all, "the engine's own constants as well, with what each rests on");
  app->add_flag("--json", command.json, "prints JSON instead of a table");
  return app;
}

int executeSettings(const SettingsCommand& command) {
  if (command.json) {
    Json json = {{"settings", settingsJson()}};
    if (command.all) json["tuning"] = tuningJson();
    fmt::print("{}\n", json.dump(2));
    return 0;
  }
  printSettings();
  if (command.all) printTuning();
  return 0;
}

}  // namespace springtower
