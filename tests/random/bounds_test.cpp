// How many scenes may have a fault.
#include "tests/random/bounds.h"

#include "core/settings.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <gtest/gtest.h>
#include <vector>

namespace springtower {
namespace {

TEST(RandomBounds, AllowNoneWhereNoneMayBe) {
  EXPECT_EQ(mostAllowed(0.0, 300), 0);
  EXPECT_EQ(mostAllowed(0.5, 0), 0);
}

// Of two scenes at one half each, both have the fault with probability 1/4, at least one with 3/4.
TEST(RandomBounds, AreThoseOfTheBinomialDistribution) {
  EXPECT_EQ(mostAllowed(0.5, 2, 0.8), 0);
  EXPECT_EQ(mostAllowed(0.5, 2, 0.3), 1);
  EXPECT_EQ(mostAllowed(0.5, 2, 0.2), 2);
}

// Chernoff's bound: P(X >= (1 + d) m) <= (e^d / (1 + d)^(1 + d))^m for the mean m; the exact count can be no larger.
TEST(RandomBounds, AreNoLargerThanChernoffs) {
  for (const double rate : {0.001, 0.02, 0.05, 0.1}) {
    for (const int scenes : {50, 300, 3000, 30000}) {
      const double mean = rate * scenes;
      double d = 0.0;
      while (mean * (d - (1.0 + d) * std::log1p(d)) > std::log(kFalseAlarm)) d += 0.01;
      EXPECT_LE(mostAllowed(rate, scenes), std::ceil((1.0 + d) * mean)) << rate << " of " << scenes;
      EXPECT_GT(mostAllowed(rate, scenes), mean);
    }
  }
}

Record soundRecord() {
  Record record;
  record.frames = 1;
  record.simulated_s = 1.0;
  record.leastSide_m = 1.0;
  return record;
}

// A record with a fault. `hung` is `slow` as well, whose bound is larger.
Record recordWith(Fault fault) {
  Record record = soundRecord();
  if (fault == Fault::crash) record.ended = "signal 11";
  if (fault == Fault::refused) record.refused = "message";
  if (fault == Fault::notFinite) record.notFinite = "block 0";
  if (fault == Fault::threads) record.sameOnTwoThreads = false;
  if (fault == Fault::program) record.programAgrees = false;
  if (fault == Fault::energy) record.energyGained = 1.0;
  if (fault == Fault::diverged) record.diverged = "block 0 diverged";
  if (fault == Fault::hung) record.ended = "limit";
  if (fault == Fault::slow) record.processor_s = 2.0;
  if (fault == Fault::deep) record.deepest_m = 1.0;
  if (fault == Fault::momentum) record.momentumLost = record.angularLost = 1.0;
  if (fault == Fault::verdict) record.sameVerdict = false;
  return record;
}

TEST(RandomBounds, AreExceededByOneMore) {
  constexpr int kScenes = 300;
  for (const Bound& bound : bounds()) {
    SCOPED_TRACE(nameOf(bound.fault));
    EXPECT_FALSE(bound.reason.empty());
    const auto most = static_cast<std::size_t>(mostAllowed(bound.rate, kScenes));
    ASSERT_LT(most, kScenes);
    std::vector<Record> records(kScenes, soundRecord());
    std::fill_n(records.begin(), most, recordWith(bound.fault));
    EXPECT_TRUE(exceededBounds(records, true).empty());
    records[most] = recordWith(bound.fault);
    EXPECT_EQ(exceededBounds(records, true), std::vector{bound.fault});
  }
}

TEST(RandomBounds, LetNoSceneOfTheDefaultMethodsDiverge) {
  for (const Method method : {Method::implicit, Method::automatic, Method::rungeKutta4}) {
    std::vector<Record> records(300, soundRecord());
    records[7] = recordWith(Fault::diverged);
    records[7].method = nameOf(method);
    EXPECT_EQ(exceededBounds(records, true).empty(), method == Method::rungeKutta4) << nameOf(method);
  }
}

TEST(RandomBounds, OfTimesCanBeLeftOut) {
  std::vector<Record> records(300);
  for (Record& record : records) record.processor_s = 1.0;
  EXPECT_EQ(exceededBounds(records, true), std::vector{Fault::slow});
  EXPECT_TRUE(exceededBounds(records, false).empty());
}

}  // namespace
}  // namespace springtower
