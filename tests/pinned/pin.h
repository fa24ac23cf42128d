#pragma once

#include "core/counters.h"
#include "tests/pinned/pinned_scene.h"

#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace springtower {

inline constexpr int kFramesAPin = 10;  ///< frames from one pinned hash to the next

/// What is pinned of a scene.
struct Pin {
  std::vector<std::uint64_t> hashes;  ///< stateHash after every kFramesAPin frames, and after the last
  Counters counters;                  ///< after the last frame
};
using Pins = std::map<std::string, Pin, std::less<>>;

/// The frame after which a hash of a scene was taken.
int frameOfHash(std::size_t hash, int frames);

/// How a scene is played: in one go; with what no frame may read before it writes it filled with NaN as each begins; or saved as
/// bytes after every kFramesAPin frames and gone on with from these in a simulation that has never been stepped.
enum class Played { atOnce, poisoned, savedAndResumed };

/// Plays a scene on so many threads, also where the machine has fewer cores. Throws DivergenceError.
Pin pinOf(const PinnedScene& scene, int threads, Played how = Played::atOnce);

/// A counter and how the file of pins calls it.
struct NamedCounter {
  std::string_view name;
  std::uint64_t Counters::*member;
};

/// All of them: none depends on times, or on how many threads there are.
inline constexpr std::array<NamedCounter, 20> kNamedCounters = {
    {{"frames", &Counters::frames},
     {"steps", &Counters::steps},
     {"replayedFrames", &Counters::replayedFrames},
     {"blockPairs", &Counters::blockPairs},
     {"clearanceChecks", &Counters::clearanceChecks},
     {"candidateTests", &Counters::candidateTests},
     {"boxOverlaps", &Counters::boxOverlaps},
     {"planeCrossings", &Counters::planeCrossings},
     {"cubicTests", &Counters::cubicTests},
     {"cubicHits", &Counters::cubicHits},
     {"contactsCreated", &Counters::contactsCreated},
     {"contactsCreatedPenetrating", &Counters::contactsCreatedPenetrating},
     {"manifoldRefreshes", &Counters::manifoldRefreshes},
     {"contactEvaluations", &Counters::contactEvaluations},
     {"springEvaluations", &Counters::springEvaluations},
     {"implicitSteps", &Counters::implicitSteps},
     {"implicitIterations", &Counters::implicitIterations},
     {"factorisations", &Counters::factorisations},
     {"newtonFailures", &Counters::newtonFailures},
     {"responseIterations", &Counters::responseIterations}}};
static_assert(sizeof(Counters) == kNamedCounters.size() * sizeof(std::uint64_t), "a new counter is pinned as well");

/// The pins of a file that writePins wrote. Throws InputError naming the file.
Pins readPins(const std::string& path);

/// Writes a file of pins, two lines for each scene so that changes show by scene. Throws InputError when it cannot.
void writePins(const std::string& path, const Pins& pins);

}  // namespace springtower
