#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace CLI {
class App;
}  // namespace CLI

namespace springtower {

/// Options of `springtower profile`. Empty lists stand for the defaults, which the help names.
struct ProfileCommand {
  std::vector<std::string> rows;
  std::vector<std::string> scenes;
  std::vector<std::string> methods;
  std::vector<std::string> tolerances_m;
  std::vector<std::string> threads;
  std::vector<std::string> towers;
  std::vector<std::string> stacks;
  std::vector<std::string> falls;
  std::optional<std::string> inertia;
  std::optional<std::int64_t> samples;
  std::optional<std::int64_t> frames;
  std::optional<double> settle_s;
  std::optional<double> prepare_s;
  std::optional<double> sample_s;
  std::optional<double> peer_s;
  std::optional<std::string> out;
  std::optional<std::string> trace;
  std::optional<std::string> from;
  bool quick = false;
  bool full = false;
  bool noResume = false;
};

/// Adds the command to the program.
CLI::App* defineProfile(CLI::App& program, ProfileCommand& command);

/// Times every case and prints a table; writes profile.json, profile.csv, culling.csv, with walls or
/// pyramids stacks.csv, with falls falls.csv, and the charts into the folder of `--out`
/// and the trace into the file of `--trace`. Scenes that are done are kept in that folder, in profile.unfinished.json, until all
/// are: a run that was broken off is gone on with (but with `--trace` all is timed again, as a trace is of one run), one of
/// another build, machine or limits, or of a build with uncommitted changes, is refused unless `--no-resume`. Cases that are kept
/// there and are none of this run's stay. Returns the exit code 0. Throws InputError before anything is timed, and Interrupted
/// when a signal has come.
int executeProfile(const ProfileCommand& command);

}  // namespace springtower
