#include "core/random.h"

#include <cmath>
#include <gtest/gtest.h>
#include <numbers>

namespace springtower {
namespace {

constexpr int kDraws = 1000000;

TEST(Random, GeneratorIsThePublishedOne) {
  SplitMix64 generator(1234567);
  for (const std::uint64_t expected : {6457827717110365317U, 3203168211198807973U, 9817491932198370423U, 4593380528125082431U}) {
    EXPECT_EQ(generator(), expected);
  }
}

// Computed by another program (Python), whose doubles round alike.
TEST(Random, SeedGivesTheSameSequenceEverywhere) {
  RandomStream uniform(1, 0);
  for (const double expected : {0x1.631405e8db1b0p-1, 0x1.f18b6c5907ee0p-1, 0x1.b4ce745d004c2p-2}) {
    EXPECT_EQ(uniform.uniform(), expected);
  }
  RandomStream normal(1, 0);
  for (const double expected : {0x1.631405e8db1b0p-1, 0x1.b0d3d1465828bp-1, -0x1.cc8fd4b3e2fdcp-1, 0x1.a5b6e1643d1d6p-1}) {
    EXPECT_EQ(normal.normal(), expected);
  }
  RandomStream otherStream(1, 1);
  EXPECT_EQ(otherStream.normal(), 0x1.349d7dbea061cp+0);
  RandomStream otherSeed(2, 0);
  EXPECT_EQ(otherSeed.normal(), 0x1.956ecd1a275e8p-4);
}

TEST(Random, UniformFillsTheUnitIntervalEvenly) {
  RandomStream random(3, 0);
  double sum = 0.0;
  double sumOfSquares = 0.0;
  for (int i = 0; i < kDraws; ++i) {
    const double value = random.uniform();
    ASSERT_GE(value, 0.0);
    ASSERT_LT(value, 1.0);
    sum += value;
    sumOfSquares += value * value;
  }
  // Five standard errors of a million draws.
  EXPECT_NEAR(sum / kDraws, 0.5, 5e-3 * std::sqrt(1.0 / 12.0));
  EXPECT_NEAR(sumOfSquares / kDraws, 1.0 / 3.0, 5e-3 * std::sqrt(4.0 / 45.0));
}

TEST(Random, ExponentialHasItsMeanAndTail) {
  RandomStream random(4, 0);
  double sum = 0.0;
  int aboveThree = 0;
  for (int i = 0; i < kDraws; ++i) {
    const double value = random.exponential();
    sum += value;
    if (value > 3.0) ++aboveThree;
  }
  EXPECT_NEAR(sum / kDraws, 1.0, 5e-3);
  const double tail = std::exp(-3.0);
  EXPECT_NEAR(static_cast<double>(aboveThree) / kDraws, tail, 5e-3 * std::sqrt(tail));
}

TEST(Random, NormalHasItsMomentsAndTails) {
  RandomStream random(5, 0);
  double moments[5] = {};
  int beyond[4] = {};
  for (int i = 0; i < kDraws; ++i) {
    const double value = random.normal();
    double power = 1.0;
    for (double& moment : moments) {
      moment += power / kDraws;
      power *= value;
    }
    for (int deviations = 1; deviations < 4; ++deviations) {
      if (value > deviations) ++beyond[deviations];
    }
  }
  // Five standard errors: the variance of the n-th power is the 2n-th moment less the n-th squared.
  EXPECT_NEAR(moments[1], 0.0, 5e-3);
  EXPECT_NEAR(moments[2], 1.0, 5e-3 * std::sqrt(2.0));
  EXPECT_NEAR(moments[3], 0.0, 5e-3 * std::sqrt(15.0));
  EXPECT_NEAR(moments[4], 3.0, 5e-3 * std::sqrt(96.0));
  for (int deviations = 1; deviations < 4; ++deviations) {
    const double tail = 0.5 * std::erfc(deviations / std::numbers::sqrt2);
    EXPECT_NEAR(static_cast<double>(beyond[deviations]) / kDraws, tail, 5e-3 * std::sqrt(tail)) << deviations << " deviations";
  }
}

TEST(Random, StreamsOfOneSeedAndSeedsOfOneStreamAreUncorrelated) {
  RandomStream first(1, 0);
  RandomStream otherStream(1, 1);
  RandomStream otherSeed(2, 0);
  double products[2] = {};
  for (int i = 0; i < kDraws; ++i) {
    const double value = first.normal();
    products[0] += value * otherStream.normal() / kDraws;
    products[1] += value * otherSeed.normal() / kDraws;
  }
  for (const double product : products) EXPECT_NEAR(product, 0.0, 5e-3);
}

}  // namespace
}  // namespace springtower
