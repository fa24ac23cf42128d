#pragma once

#include "apps/commands/profile/profile.h"
#include "core/scene/scene.h"

#include <iosfwd>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace springtower {

// What moves in large numbers: towers that topple or are hit, heaps, piles, rain. Each run is timed from the first frame after
// its start to its end, all blocks awake.

/// A kind of fall, by a name and a size.
struct FallFamily {
  std::string_view name;
  std::string_view usage;  ///< name with the letter of its size: "heap:BLOCKS"
  std::string_view what;   ///< in a chart: "heaps"
  ProfileScene scene;
  int most;    ///< of its size, which is at least 1
  int frames;  ///< timed, of 1/60 s
  Scene (*make)(int size);
};
std::span<const FallFamily> fallFamilies();

/// The family of a fall, by name and size. Precondition: there is one.
const FallFamily& fallFamilyOf(std::string_view fall);

/// What a fall shall meet on one thread, ms of processor time a frame: median and worst; and its depth, mm. Required is what
/// Box3D takes with eight steps of four substeps in the median, and 1.5 times as much in the worst frame.
struct FallGoal {
  std::string_view fall;
  double required_ms;
  double requiredWorst_ms;
  double goal_ms;
  double goalWorst_ms;
  double required_mm = 1.0;
};
std::span<const FallGoal> fallGoals();

/// Bounds for every fall: the largest rise of energy in a frame, of what there was at the start; memory, bytes a block; how many
/// times as fast two threads are from so many blocks on.
inline constexpr double kMaxFallEnergyRise = 1e-4;
inline constexpr double kMaxFallBytes = 8000.0;
inline constexpr double kLeastTwoThreads = 1.6;
inline constexpr std::size_t kTwoThreadsBlocks = 300;

/// The falls that are timed when none are named: in a few seconds, in some two minutes, or with the largest as well.
std::vector<std::string> fallsOf(ProfileScene scene, ProfileExtent extent);

/// A fall as given on the command line, checked. Throws InputError naming `--falls`, what is expected and what it got.
std::string fallFrom(const std::string& text);

/// The blocks of a fall. Precondition: fallFrom has taken it.
Scene fallScene(const std::string& fall);

/// A table of the falls of a profile, a line each: ms a frame on one thread (median, worst), how many times as fast two threads
/// are, depth, rise of energy, memory, what is required, whether it is met, and another engine beside. Nothing when there are
/// none.
void printFalls(const Profile& profile);

/// The same as CSV, a line for each fall and number of threads, and a line for each setting of the other engine.
void writeFallsCsv(std::ostream& stream, const Profile& profile);

}  // namespace springtower
