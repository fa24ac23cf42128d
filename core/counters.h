#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace springtower {

/// The stages of a frame (broadphase, candidates, cubic tests, springs, contacts, integration, islands and sleep).
enum class Stage : std::size_t { broadphase, candidates, cubicTests, springs, contacts, integration, islandsAndSleep };
inline constexpr std::size_t kStages = 7;
inline constexpr std::array<std::string_view, kStages> kStageNames = {"broadphase", "candidates",  "cubic_tests",      "springs",
                                                                      "contacts",   "integration", "islands_and_sleep"};

/// What happened, counted; sums over a run unless said otherwise. The staged culling is the report's Table 5.2.
struct Counters {
  std::uint64_t frames = 0;
  std::uint64_t steps = 0;            ///< substeps: over all islands the most in a frame, summed
  std::uint64_t replayedFrames = 0;   ///< frames run again: with a wider sweep, or with sleepers awake whose supports failed
  std::uint64_t blockPairs = 0;       ///< pairs of blocks whose swept boxes overlap
  std::uint64_t clearanceChecks = 0;  ///< of these, pairs looked at because their clearance was used up
  std::uint64_t candidateTests = 0;   ///< feature pairs of block pairs whose clearance was used up
  std::uint64_t boxOverlaps = 0;      ///< of these, swept boxes overlap
  std::uint64_t planeCrossings = 0;   ///< of these, the coplanarity cubic may vanish (report: plane intersection tests)
  std::uint64_t cubicTests = 0;       ///< of these, tested in full
  std::uint64_t cubicHits = 0;        ///< of these, the features met
  std::uint64_t contactsCreated = 0;  ///< contacts created by a cubic test
  std::uint64_t contactsCreatedPenetrating = 0;  ///< of these, found too late; 0 unless settings forbid the tests
  std::uint64_t manifoldRefreshes = 0;
  std::uint64_t contactEvaluations = 0;  ///< contact points times evaluations of their forces
  std::uint64_t springEvaluations = 0;   ///< springs times force evaluations
  std::uint64_t implicitSteps = 0;       ///< steps taken by the implicit method, over all islands
  std::uint64_t implicitIterations = 0;  ///< linear systems solved in these
  std::uint64_t factorisations = 0;
  std::uint64_t newtonFailures = 0;      ///< implicit steps that did not converge
  std::uint64_t responseIterations = 0;  ///< passes of the report's collision loop

  Counters& operator+=(const Counters& other);
};

/// Seconds spent in each stage.
struct StageTimes {
  std::array<double, kStages> seconds{};
  StageTimes& operator+=(const StageTimes& other) {
    for (std::size_t i = 0; i < kStages; ++i) seconds[i] += other.seconds[i];
    return *this;
  }
};

/// Adds the time of its scope to a stage.
class StageTimer {
 public:
  StageTimer(StageTimes& times, Stage stage) : times_(times), stage_(stage), start_(std::chrono::steady_clock::now()) {}
  StageTimer(const StageTimer&) = delete;
  StageTimer& operator=(const StageTimer&) = delete;
  ~StageTimer() {
    const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - start_;
    times_.seconds[static_cast<std::size_t>(stage_)] += elapsed.count();
  }

 private:
  StageTimes& times_;
  Stage stage_;
  std::chrono::steady_clock::time_point start_;
};

}  // namespace springtower
