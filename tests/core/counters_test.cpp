#include "core/counters.h"

#include <array>
#include <bit>
#include <cstdint>
#include <gtest/gtest.h>

namespace springtower {
namespace {

// Counters seen as the row of numbers they are, so that a counter added later is tested as well.
constexpr std::size_t kCounters = sizeof(Counters) / sizeof(std::uint64_t);
using Row = std::array<std::uint64_t, kCounters>;

TEST(Counters, SumHoldsEveryCounter) {
  Row ones{};
  Row twos{};
  for (std::size_t i = 0; i < kCounters; ++i) {
    ones[i] = i + 1;
    twos[i] = 1000 * (i + 1);
  }
  auto sum = std::bit_cast<Counters>(ones);
  sum += std::bit_cast<Counters>(twos);
  const auto result = std::bit_cast<Row>(sum);
  for (std::size_t i = 0; i < kCounters; ++i) EXPECT_EQ(result[i], 1001 * (i + 1)) << "counter " << i;
}

TEST(StageTimes, TimerAddsToItsStageOnly) {
  StageTimes times;
  { const StageTimer timer(times, Stage::contacts); }
  { const StageTimer timer(times, Stage::contacts); }
  for (std::size_t stage = 0; stage < kStages; ++stage) {
    const bool timed = stage == static_cast<std::size_t>(Stage::contacts);
    EXPECT_EQ(times.seconds[stage] > 0.0, timed) << kStageNames[stage];
  }
  StageTimes sum = times;
  sum += times;
  EXPECT_EQ(sum.seconds[static_cast<std::size_t>(Stage::contacts)],
            2.0 * times.seconds[static_cast<std::size_t>(Stage::contacts)]);
}

}  // namespace
}  // namespace springtower
