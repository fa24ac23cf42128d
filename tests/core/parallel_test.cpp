#include "core/parallel.h"

#include <atomic>
#include <gtest/gtest.h>
#include <vector>

namespace springtower {
namespace {

TEST(EqualRanges, CoverEveryIndexOnceOnAnyThreads) {
  for (const std::size_t threads : {1U, 2U, 4U}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    for (const std::size_t count : {0U, 1U, 15U, 16U, 17U, 1000U}) {
      std::vector<std::atomic<int>> visits(count);
      forEqualRanges(count, 16, true, [&](std::size_t first, std::size_t last) {
        for (std::size_t i = first; i < last; ++i) ++visits[i];
      });
      for (std::size_t i = 0; i < count; ++i) EXPECT_EQ(visits[i], 1) << i << " of " << count << " on " << threads;
    }
  }
}

TEST(EqualRanges, AreOneCallWhereNotParallel) {
  std::vector<std::size_t> calls;
  forEqualRanges(1000, 16, false, [&](std::size_t first, std::size_t last) { calls.insert(calls.end(), {first, last}); });
  EXPECT_EQ(calls, (std::vector<std::size_t>{0, 1000}));
}

}  // namespace
}  // namespace springtower
