// The stand-in for oneTBB: the same ranges and bits, nested calls, errors of other threads.
#include "core/plain_threads.h"

#include <array>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <gtest/gtest.h>
#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_reduce.h>
#include <stdexcept>
#include <thread>
#include <vector>

namespace springtower {
namespace {

constexpr std::array<std::size_t, 7> kCounts = {0, 1, 63, 64, 65, 1000, 4097};
constexpr std::size_t kGrain = 64;

TEST(PlainThreads, RunEveryIndexOnce) {
  for (const std::size_t count : kCounts) {
    std::vector<int> times(count, 0);
    plain::forRanges(count, kGrain, 4, [&](std::size_t first, std::size_t last) {
      EXPECT_LE(last - first, kGrain);
      for (std::size_t i = first; i < last; ++i) ++times[i];
    });
    EXPECT_EQ(times, std::vector<int>(count, 1));
  }
}

// Terms of all sizes, so that the order of the sum shows in its bits.
double termsFrom(std::size_t first, std::size_t last) {
  double sum = 0.0;
  for (std::size_t i = first; i < last; ++i)
    sum += std::sin(static_cast<double>(i)) * std::pow(10.0, static_cast<double>(i % 17));
  return sum;
}

std::uint64_t bitsOf(double value) {
  std::uint64_t bits = 0;
  std::memcpy(&bits, &value, sizeof bits);
  return bits;
}

TEST(PlainThreads, SumAsOneTbbDoes) {
  for (const std::size_t count : kCounts) {
    const double expected = tbb::parallel_deterministic_reduce(
        tbb::blocked_range<std::size_t>(0, count, kGrain), 0.0,
        [](const tbb::blocked_range<std::size_t>& range, double sofar) { return sofar + termsFrom(range.begin(), range.end()); },
        [](double a, double b) { return a + b; });
    for (const std::size_t threads : {1, 3, 4}) {
      EXPECT_EQ(bitsOf(plain::sumRanges(count, kGrain, threads, termsFrom)), bitsOf(expected)) << count << ' ' << threads;
    }
  }
}

TEST(PlainThreads, MergeEveryRange) {
  const auto holds = [](std::size_t index) {
    return plain::mergeRanges(
        std::size_t{1000}, kGrain, 4, false, [&](std::size_t first, std::size_t last) { return first <= index && index < last; },
        [](bool a, bool b) { return a || b; });
  };
  EXPECT_TRUE(holds(0));
  EXPECT_TRUE(holds(999));
  EXPECT_FALSE(holds(1000));
}

TEST(PlainThreads, MayBeNested) {
  std::atomic<int> calls{0};
  plain::forParts(5, 4, [&](std::size_t) { plain::forRanges(256, kGrain, 4, [&](std::size_t, std::size_t) { ++calls; }); });
  EXPECT_EQ(calls, 20);
}

TEST(PlainThreads, NeighboursRunOnDifferentThreads) {
  std::array<std::thread::id, 8> ids;
  plain::forParts(ids.size(), 4, [&](std::size_t i) { ids[i] = std::this_thread::get_id(); });
  for (std::size_t i = 1; i < ids.size(); ++i) EXPECT_NE(ids[i], ids[i - 1]);
  EXPECT_EQ(ids[0], std::this_thread::get_id());
}

TEST(PlainThreads, ThrowWhatAnotherThreadHasThrown) {
  const auto fail = [](std::size_t i) {
    if (i == 3) throw std::runtime_error("three");
  };
  EXPECT_THROW(plain::forParts(4, 4, fail), std::runtime_error);
}

}  // namespace
}  // namespace springtower
