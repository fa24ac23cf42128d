// How many scenes may have a fault.
#include "tests/random/bounds.h"

#include <cmath>
#include <gtest/gtest.h>

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

TEST(RandomBounds, AreExceededByOneMore) {
  for (const Bound& bound : bounds()) {
    EXPECT_FALSE(bound.reason.empty()) << nameOf(bound.fault);
    std::vector<Record> records(300);
    for (Record& record : records) {
      record.frames = 1;
      record.simulated_s = 1.0;
      record.leastSide_m = 1.0;
    }
    EXPECT_TRUE(exceededBounds(records, true).empty());
  }
  std::vector<Record> records(300);
  records[7].sameOnTwoThreads = false;
  EXPECT_EQ(exceededBounds(records, true), std::vector{Fault::threads});
}

TEST(RandomBounds, OfTimesCanBeLeftOut) {
  std::vector<Record> records(300);
  for (Record& record : records) record.processor_s = 1.0;
  EXPECT_EQ(exceededBounds(records, true), std::vector{Fault::slow});
  EXPECT_TRUE(exceededBounds(records, false).empty());
}

}  // namespace
}  // namespace springtower
