// The command line program. Its exit codes are those of apps/common/program.h, and 1 where an answer differs (--check).
#include "apps/commands/chart/command.h"
#include "apps/commands/profile/command.h"
#include "apps/commands/run/command.h"
#include "apps/commands/scenes/command.h"
#include "apps/commands/settings/command.h"
#include "apps/commands/statics/command.h"
#include "apps/commands/validate/command.h"
#include "apps/commands/verdict/verdict.h"
#include "apps/common/arguments.h"
#include "apps/common/program.h"
#include "core/version.h"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

namespace springtower {
namespace {

constexpr std::string_view kFooter = R"help(examples:
  springtower run tower:18                          the full tower for 10 simulated seconds
  springtower scenes                                which scenes there are
  springtower run "(010)-(010)-(011)" --seconds 5 --picture tower.png
  springtower verdict towers.jsonl                  which towers of a list stand
  springtower profile --quick                       how long a frame takes
  springtower statics tower:18                      whether it can stand at all, and by what margin
  springtower chart --quick                         speed against accuracy, every method
  springtower validate --out validation             every claim about it, measured
  springtower settings --all                        what can be set, and the engine's own constants
  springtower run --help                            all options of a command
exit codes: 0 done, 1 an answer differs (--check), 2 bad input or no place for the output, 3 the simulation diverged, 130 and 143
ended by SIGINT (Ctrl-C) and SIGTERM: what was done is kept, and a second signal ends at once)help";

// CLI11 has an exit code for each kind of mistake; here they are all bad arguments.
int complainAboutArguments(const CLI::App& program, const CLI::ParseError& error) {
  std::string hint = "springtower --help";
  for (const CLI::App* command : program.get_subcommands()) hint = fmt::format("springtower {} --help", command->get_name());
  const std::string commands = "run, verdict, profile, statics, chart, validate, scenes and settings";
  const bool noCommand = program.get_subcommands().empty() && error.get_name() == "RequiredError";
  std::string complaint = complaintAbout(program, error);
  if (noCommand) {
    complaint = program.remaining().empty() ? fmt::format("expected a command among {}, got none", commands)
                                            : fmt::format("{}; commands are {}", complaint, commands);
  }
  complain("springtower", complaint);
  fmt::print(stderr, "Try '{}'.\n", hint);
  return kBadInput;
}

int run(int argc, char** argv) {
  CLI::App program("Simulates stacks of wooden blocks: whether they stand, how they fall, what each block carries.",
                   "springtower");
  program.set_help_flag("-h,--help", "prints this help");
  program.set_version_flag("--version", fmt::format("springtower {} ({}, {})", kVersion, kGitCommit, kBuildType),
                           "prints the version");
  program.set_help_all_flag("--help-all", "prints the help of all commands");
  program.require_subcommand(1);
  program.footer(std::string(kFooter));
  program.get_formatter()->column_width(34);
  RunCommand runCommand;
  VerdictCommand verdictCommand;
  ProfileCommand profileCommand;
  StaticsCommand staticsCommand;
  ValidateCommand validateCommand;
  const CLI::App* runApp = defineRun(program, runCommand);
  defineVerdict(program, verdictCommand);
  const CLI::App* profileApp = defineProfile(program, profileCommand);
  const CLI::App* staticsApp = defineStatics(program, staticsCommand);
  ChartCommand chartCommand;
  const CLI::App* chartApp = defineChart(program, chartCommand);
  const CLI::App* validateApp = defineValidate(program, validateCommand);
  SettingsCommand settingsCommand;
  const CLI::App* settingsApp = defineSettings(program, settingsCommand);
  const CLI::App* scenesApp = defineScenes(program);
  try {
    program.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return program.exit(error);
    return complainAboutArguments(program, error);
  }
  if (profileApp->parsed()) return executeProfile(profileCommand);
  if (staticsApp->parsed()) return executeStatics(staticsCommand);
  if (chartApp->parsed()) return executeChart(chartCommand);
  if (validateApp->parsed()) return executeValidate(validateCommand);
  if (settingsApp->parsed()) return executeSettings(settingsCommand);
  if (scenesApp->parsed()) return executeScenes();
  return runApp->parsed() ? executeRun(runCommand) : executeVerdict(verdictCommand);
}

}  // namespace
}  // namespace springtower

int main(int argc, char** argv) {
  return springtower::exitCodeOf("springtower", [&] { return springtower::run(argc, argv); });
}
