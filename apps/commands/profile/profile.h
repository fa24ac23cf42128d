#pragma once

#include "apps/common/provenance.h"
#include "core/counters.h"
#include "core/settings.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace springtower {

/// What the blocks do while they are timed.
enum class ProfileScene {
  rest,       ///< a tower that has settled, all blocks awake
  sway,       ///< the same while gravity sways by 0.1 degree once a second
  heights,    ///< a settled tower whose heights vary by 0.2 mm, awake
  pull,       ///< a block is pulled out of the middle row at 4 cm/s, all blocks awake
  pullSleep,  ///< the same with sleep on
  game,       ///< the recorded game (scenarios/recorded/recorded_game.h), whole, as the viewer plays it
  collapse,   ///< gravity leans by 14.5 degrees from the start, for fewer than 18 rows by more than they stand at
  asleep,     ///< all blocks asleep
  towers,     ///< many towers side by side at rest, awake
  pile,       ///< one wide stack of 108 blocks a row that lands after a fall of 10 cm
  walls,      ///< walls in running bond at rest, awake
  pyramids,   ///< pyramids of cubes and of bricks at rest, awake
  starts,     ///< towers whose search for the equilibrium is timed: equal, uneven, tilted, many
  topple,     ///< towers that topple under gravity that leans by 14.5 degrees
  hit,        ///< towers that a block flies at
  heaps,      ///< blocks turned at random that fall from a lattice
  piles,      ///< wide connected stacks that land after a fall of 10 cm
  rain        ///< blocks that land one after the other
};

/// Names as the command line spells them, in the order of the enumeration.
inline constexpr auto kProfileSceneNames =
    std::to_array<std::string_view>({"rest", "sway", "heights", "pull", "pull-sleep", "game", "collapse", "asleep", "towers",
                                     "pile", "walls", "pyramids", "starts", "topple", "hit", "heaps", "piles", "rain"});
constexpr std::string_view nameOf(ProfileScene scene) {
  return kProfileSceneNames[static_cast<std::size_t>(scene)];
}

/// Whether a scene is of stacks by name and size (apps/commands/profile/stacks.h).
constexpr bool isStack(ProfileScene scene) {
  return scene >= ProfileScene::walls && scene <= ProfileScene::starts;
}

/// Whether a scene is of what moves in large numbers, by name and size (apps/commands/profile/falls.h).
constexpr bool isFall(ProfileScene scene) {
  return scene >= ProfileScene::topple;
}

/// Whether a scene's cases have names with sizes; those of the others have rows and towers.
constexpr bool isNamed(ProfileScene scene) {
  return isStack(scene) || isFall(scene);
}

/// How many of a scene's named cases are timed: for a few seconds, usually, or with the largest, for minutes.
enum class ProfileExtent { quick, usual, full };

/// One line of a profile's charts at one place: what is timed.
struct ProfileCase {
  ProfileScene scene = ProfileScene::rest;
  int rows = 0;
  int towers = 1;
  Method method = Settings{}.method;
  Inertia inertia = Settings{}.inertia;
  double tolerance_m = 0.0;
  int threads = 1;
  std::string named =
      {};  ///< its name and size, such as wall:20x12, where a scene has such; `rows` and `towers` then mean nothing
  bool operator==(const ProfileCase&) const = default;
};

/// How long to prepare and to measure.
struct ProfileLimits {
  int samples = 5;          ///< restored to the same state and run by turns with those of the other cases
  int frames = 120;         ///< timed in a sample; the first one after the state is restored is left out
  double settle_s = 5.0;    ///< simulated before the state is kept
  double prepare_s = 10.0;  ///< s of wall time after which preparing ends, settled or not
  double sample_s = 1.0;    ///< s of wall time after which a sample ends early
  double peer_s = 4.0;      ///< s of processor time that another engine may take for a stack, with all its settings
  bool operator==(const ProfileLimits&) const = default;
};

/// Median, 99th percentile and largest of the frames, ms.
struct FrameCost {
  double median = 0.0;
  double p99 = 0.0;
  double max = 0.0;
};

/// What another engine made of a stack, with one of its settings.
struct PeerFigures {
  std::string engine;
  int substeps = 1;             ///< equal steps of a frame
  double frame_ms = 0.0;        ///< median of processor time, one thread
  double worst_ms = 0.0;        ///< of its frames but the first
  double penetration_mm = 0.0;  ///< largest in the second half of the time it was looked at; of a fall, in all of it
  double simulated_s = 0.0;     ///< that time
  bool stands = true;           ///< at its end
};

/// The counters of a frame that a profile keeps, by name.
inline constexpr auto kCounterNames = std::to_array<std::pair<std::string_view, std::uint64_t Counters::*>>(
    {{"frames", &Counters::frames},
     {"steps", &Counters::steps},
     {"replayed_frames", &Counters::replayedFrames},
     {"block_pairs", &Counters::blockPairs},
     {"margins_spent", &Counters::clearanceChecks},
     {"candidate_tests", &Counters::candidateTests},
     {"box_overlaps", &Counters::boxOverlaps},
     {"plane_crossings", &Counters::planeCrossings},
     {"cubic_tests", &Counters::cubicTests},
     {"cubic_hits", &Counters::cubicHits},
     {"contacts_born", &Counters::contactsCreated},
     {"contacts_born_penetrating", &Counters::contactsCreatedPenetrating},
     {"manifold_refreshes", &Counters::manifoldRefreshes},
     {"contact_evaluations", &Counters::contactEvaluations},
     {"spring_evaluations", &Counters::springEvaluations},
     {"response_iterations", &Counters::responseIterations}});

/// What came of a case. The frames of every sample are the same frames, so of each the least time over the samples is what it
/// costs and the rest is other programs' doing; `raw` are the times as they came.
struct ProfileResult {
  ProfileCase what;
  std::string methodName;  ///< nameOf(what.method)
  std::size_t blocks = 0;
  std::string failure;      ///< empty, or why there is no time: diverged, does not fall asleep
  double prepared_s = 0.0;  ///< simulated before the measurement
  int frames = 0;           ///< timed in each sample
  int samples = 0;
  FrameCost processor_ms;                  ///< of the whole process, over all threads; least over the samples
  FrameCost wall_ms;                       ///< least over the samples
  FrameCost rawWall_ms;                    ///< of all frames of all samples
  std::array<double, kStages> stage_ms{};  ///< mean a frame, of the samples with the least wall time; summed over threads
  std::array<double, kCounterNames.size()> counted{};  ///< a frame, in the order of kCounterNames
  double substeps = 0.0;                               ///< mean a frame
  double stiffness_n_m = 0.0;                          ///< of one resting contact
  double penetration_mm = 0.0;                         ///< largest while measured
  double compression_mm = 0.0;                         ///< of the bottom row when the state was kept
  bool stands = true;                                  ///< at the end of the sample; a block that is pulled does not count
  double stateBytes = 0.0;                             ///< a block
  double contactBytes = 0.0;                           ///< a block
  double allBytes = 0.0;                               ///< a block: these, the springs, and working space
  double pairBytes = 0.0;                              ///< a near pair, touching or not
  double touchingBytes = 0.0;                          ///< that a touching pair adds
  double touchingStepBytes = 0.0;                      ///< and for steps and rollbacks
  double equilibrium_s = 0.0;      ///< processor time of the search for the equilibrium; of stacks alone, as are
  double creepPerMinute_mm = 0.0;  ///< the largest move of a corner while measured, mm a minute
  double energyRise = 0.0;         ///< largest in a frame, of what there was at the start; of falls alone
  std::vector<PeerFigures> peers;  ///< other engines; of the first case of those with one preparation; of stacks and falls
  std::vector<double> frame_ms;    ///< `cost` of each frame, least over the samples

  /// What a frame costs, for charts: processor time on one thread, which other programs disturb least; wall time on more.
  [[nodiscard]] const FrameCost& cost() const { return what.threads == 1 ? processor_ms : wall_ms; }
  [[nodiscard]] double framesPerSecond() const { return cost().median > 0.0 ? 1e3 / cost().median : 0.0; }
};

/// A whole profile: what is written to JSON and can be read back.
struct Profile {
  Provenance provenance;
  ProfileLimits limits;
  std::vector<ProfileResult> results;
};

/// The value of a counter of a result, a frame. Precondition: the name is in kCounterNames.
double counted(const ProfileResult& result, std::string_view name);

}  // namespace springtower
