#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace CLI {
class App;
}  // namespace CLI

namespace springtower {

/// Options of `springtower validate`.
struct ValidateCommand {
  std::string out;
  std::vector<std::string> only;
  std::string oracle = "tests/data/oracle";
  std::string scenes = "scenes";
  std::optional<std::int64_t> threads;
  bool longForm = false;
  bool check = false;
  bool noResume = false;
};

/// Adds the command to the program.
CLI::App* defineValidate(CLI::App& program, ValidateCommand& command);

/// Measures, prints a line a claim, writes the page and its figures. Parts that are done are kept beside the page, in
/// validation.unfinished.json, until all are: a run that was broken off is gone on with, one of another build, machine, form or
/// reference sets, or of a build with uncommitted changes, is refused unless `--no-resume`. Returns the exit code: 1 where
/// --check found a claim that fails. Throws InputError before anything is measured, and Interrupted when a signal has come.
int executeValidate(const ValidateCommand& command);

}  // namespace springtower
