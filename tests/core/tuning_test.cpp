// The table of constants says of each what it is for and what it rests on.
#include "core/tuning.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <gtest/gtest.h>
#include <set>
#include <string_view>

namespace springtower {
namespace {

TEST(Tuning, EveryConstantHasAUnitAPurposeAndItsEvidence) {
  std::set<std::string_view> names;
  for (const TuningRow& row : tuningTable()) {
    EXPECT_TRUE(names.insert(row.name).second) << row.name << " twice";
    EXPECT_FALSE(row.group.empty()) << row.name;
    EXPECT_FALSE(row.unit.empty()) << row.name;
    EXPECT_GE(row.purpose.size(), 15U) << row.name;
    EXPECT_FALSE(row.evidence.empty()) << row.name << ": none where there is none";
    EXPECT_TRUE(std::isfinite(row.value)) << row.name;
  }
  EXPECT_GE(names.size(), 190U);
}

TEST(Tuning, TheTableHoldsTheConstantsThemselves) {
  const auto row =
      std::find_if(tuningTable().begin(), tuningTable().end(), [](const TuningRow& one) { return one.name == "kManifoldReach"; });
  ASSERT_NE(row, tuningTable().end());
  EXPECT_EQ(row->value, tuning::kManifoldReach);
  EXPECT_EQ(row->expression, "3.0 * kRefreshTravel") << "derived ones are expressions";
}

}  // namespace
}  // namespace springtower
