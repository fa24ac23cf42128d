#pragma once

#include "apps/commands/profile/profile.h"
#include "core/scene/scene.h"

#include <array>
#include <iosfwd>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace springtower {

// Walls and pyramids of many sizes, one wide island each, and towers whose start takes a search: at rest and awake. What they are
// held to, how their cost grows with the number of blocks, and what another engine makes of them.

/// A kind of stack: its name is that of its scene in scenarios/registry.h, where that has one.
struct StackFamily {
  std::string_view name;
  std::string_view usage;  ///< name with the letters of its size: "wall:CxR"
  std::string_view what;   ///< in a chart: "walls, running bond"
  ProfileScene scene;
  std::array<int, 2> most;  ///< of the numbers of its size, each at least 1; the second is 0 where there is one number
  Scene (*make)(int first, int second);
};
inline constexpr std::size_t kStackFamilies = 8;
std::span<const StackFamily> stackFamilies();

/// The family of a stack, by name or by name and size. Precondition: there is one.
const StackFamily& familyOf(std::string_view stack);

/// What a stack shall meet, where something is set. Times are of a frame, ms, on one thread and on two; NaN where nothing is.
struct StackGoal {
  std::string_view stack;
  std::array<double, 2> required_ms;
  std::array<double, 2> goal_ms;
  double equilibrium_s;  ///< that the search for the equilibrium may take, s
};
std::span<const StackGoal> stackGoals();

/// Bounds for every stack, besides that none is deeper than its tolerance.
inline constexpr double kMaxStackCreepPerMinute_mm = 0.001;
inline constexpr double kMaxGrowthExponent = 1.25;
inline constexpr std::size_t kGrowthLeastBlocks = 240;  ///< smaller stacks are left out of it

/// Gravity of the leaning starts, as a share of the slope at which a tower of rigid blocks tips over or slides.
inline constexpr double kStartTiltShare = 0.5;

/// The stacks that are timed when none are named: in a few seconds, in some two minutes, or with the largest as well.
std::vector<std::string> stacksOf(ProfileScene scene, ProfileExtent choice);

/// A stack as given on the command line, checked: the name of a family, a colon and its size. Throws InputError naming
/// `--stacks`, what is expected and what it got.
std::string stackFrom(const std::string& text);

/// The blocks of a stack. Precondition: stackFrom has taken it.
Scene stackScene(const std::string& stack);

/// The power of the number of blocks with which the cost of a frame grows: the slope of the line through the logarithms with the
/// least squares. `blocks` and `ms`: positive, of equal number. Empty for fewer than two different numbers of blocks.
std::optional<double> growthExponent(std::span<const double> blocks, std::span<const double> ms);

/// The growth of a family on so many threads.
struct StackGrowth {
  std::string_view family;
  int threads;
  std::size_t least;  ///< blocks of the smallest stack that counts, and of the largest
  std::size_t most;
  double exponent;
};
std::vector<StackGrowth> stackGrowth(const Profile& profile);

/// Of another engine's settings those with which it is as deep as our result or nearest to it, as a ratio; among settings with
/// which it stands, if there are any. Null where none were measured.
const PeerFigures* nearestInAccuracy(const ProfileResult& result);

/// A table of the stacks of a profile, a line each: ms a frame on each number of threads, depth, creep, the search for the
/// equilibrium, what is required, whether it is met, and the other engine beside; below it the growth of each family. Nothing
/// when there are none.
void printStacks(const Profile& profile);

/// The same as CSV, a line for each stack and number of threads, and a line for each setting of the other engine.
void writeStacksCsv(std::ostream& stream, const Profile& profile);

}  // namespace springtower
