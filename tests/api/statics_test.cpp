// Statics through the public interface, against closed forms.
#include "tests/support/says.h"

#include <cmath>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <limits>
#include <springtower/statics.h>

namespace springtower::api {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

constexpr double kOneWeight_n = 0.0196 * 9.81;

// Blocks upon each other, the upper ones set off sideways.
Scene stackOf(int count, double offset_m = 0.0) {
  Scene scene;
  scene.name = "stack";
  scene.blocks.resize(static_cast<std::size_t>(count));
  for (std::size_t b = 0; b < scene.blocks.size(); ++b) {
    scene.blocks[b].centre.y = static_cast<double>(b) * offset_m;
    scene.blocks[b].centre.z = (static_cast<double>(b) + 0.5) * 0.0182;
  }
  return scene;
}

TEST(ApiStatics, ABlockStandsUpToItsEdge) {
  EXPECT_EQ(verdict(stackOf(2, 0.013)), Verdict::stands);
  EXPECT_EQ(verdict(stackOf(2, 0.014)), Verdict::falls);  // half of its width is 13.35 mm
  EXPECT_EQ(verdictWithout(stackOf(2), 1), Verdict::stands);
  EXPECT_EQ(verdictWithout(stackOf(2), 0), Verdict::falls);
}

// A single block slides at the angle of friction, before it topples at atan(width / height).
TEST(ApiStatics, TheMarginOfABlockIsItsAngleOfFriction) {
  const auto margin = stabilityMargin(stackOf(1));
  ASSERT_TRUE(margin.has_value());
  EXPECT_NEAR(margin->tilt_deg, std::atan(0.4) * 180.0 / std::acos(-1.0), 0.005);
}

TEST(ApiStatics, LoadsAreTheWeightsAbove) {
  const auto found = loads(stackOf(3));
  ASSERT_TRUE(found.has_value());
  ASSERT_EQ(found->blocks.size(), 3U);
  EXPECT_FALSE(found->anyOfMany);
  for (std::size_t b = 0; b < 3; ++b) {
    const double above_n = (2.0 - static_cast<double>(b)) * kOneWeight_n;
    EXPECT_NEAR(found->blocks[b].weight_n, kOneWeight_n, 1e-12);
    EXPECT_NEAR(found->blocks[b].above_n, above_n, 1e-6 * kOneWeight_n);
    EXPECT_NEAR(found->blocks[b].leastAbove_n, above_n, 1e-6 * kOneWeight_n);
    EXPECT_FALSE(found->blocks[b].loose);
    EXPECT_EQ(found->blocks[b].covered, b < 2);
  }
  ASSERT_EQ(found->contacts.size(), 3U);
  for (const StaticContact& contact : found->contacts) {
    const double carried_n = (contact.lower == kFloor ? 3.0 : contact.lower == 0 ? 2.0 : 1.0) * kOneWeight_n;
    EXPECT_NEAR(contact.normal_n, carried_n, 1e-6 * kOneWeight_n);
    EXPECT_NEAR(std::abs(contact.force_n.z), carried_n, 1e-6 * kOneWeight_n);
    EXPECT_NEAR(contact.frictionUsed, 0.0, 1e-6);
  }
  EXPECT_EQ(loads(stackOf(2, 0.014)), std::nullopt);
}

// Coulomb's bound for the upper of two blocks; 1e-6 is what the linear program is solved to.
TEST(ApiStatics, FrictionHoldsAPullUpToItsBound) {
  const auto limit = pullLimit(stackOf(2), 1, {5.0, 0.0, 0.0});
  ASSERT_TRUE(limit.has_value());
  EXPECT_NEAR(*limit, 0.4 * kOneWeight_n, 1e-6);
  EXPECT_EQ(pullLimit(stackOf(2, 0.014), 1, {1.0, 0.0, 0.0}), std::nullopt);
}

TEST(ApiStatics, RefusesWhatIsNotAllowed) {
  Scene weightless = stackOf(1);
  weightless.gravity.magnitude_m_s2 = 0.0;
  EXPECT_THAT([&] { static_cast<void>(verdict(weightless)); },
              ThrowsMessage<InputError>(HasSubstr("stack: expected gravity above 0 for statics, got none")));
  EXPECT_THAT([] { static_cast<void>(verdict(Scene{})); },
              ThrowsMessage<InputError>(says("number of blocks: expected ..., got 0")));
  EXPECT_THAT([] { static_cast<void>(loads(towerScene(334))); },
              ThrowsMessage<InputError>(HasSubstr("expected 1 to 1000 blocks for statics, got 1002")));
  EXPECT_THAT([] { static_cast<void>(verdictWithout(stackOf(1), 0)); },
              ThrowsMessage<InputError>(HasSubstr("expected at least two blocks to leave one out, got one")));
  EXPECT_THAT([] { static_cast<void>(verdictWithout(stackOf(2), 2)); },
              ThrowsMessage<InputError>(HasSubstr("expected 0 to 1, got 2")));
  EXPECT_THAT(
      [] {
        static_cast<void>(pullLimit(stackOf(2), -1, {1.0, 0.0, 0.0}));
      },
      ThrowsMessage<InputError>(HasSubstr("expected 0 to 1, got -1")));
  EXPECT_THAT([] { static_cast<void>(verdictWithout(Scene{}, 0)); },
              ThrowsMessage<InputError>(says("number of blocks: expected ..., got 0")));
  EXPECT_THAT(
      [] {
        static_cast<void>(pullLimit(Scene{}, 0, {1.0, 0.0, 0.0}));
      },
      ThrowsMessage<InputError>(says("number of blocks: expected ..., got 0")));
  for (const Vec3& direction : {Vec3{}, Vec3{std::numeric_limits<double>::quiet_NaN(), 0.0, 0.0}}) {
    EXPECT_THAT([&] { static_cast<void>(pullLimit(stackOf(2), 1, direction)); },
                ThrowsMessage<InputError>(HasSubstr("direction: expected a finite length above 0, got ")));
  }
}

}  // namespace
}  // namespace springtower::api
