#include "tests/structure/reached_names.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace springtower {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

TEST(ReachedNames, AHeaderReachesWhatItNames) {
  const std::string wheel = "#pragma once\nstruct Wheel {\n  int spokes;\n};\ninline constexpr int kWheels = 4;\n";
  const std::string axle = "#pragma once\n#include \"core/wheel.h\"\nstruct Axle {\n  Wheel wheel[kWheels];\n};\n";
  EXPECT_THAT(namesNotReached({{"core/axle.h", axle}, {"core/wheel.h", wheel}}), IsEmpty());

  const std::string through = "#include \"core/axle.h\"\nvoid turn(Wheel& wheel);\n";
  EXPECT_THAT(namesNotReached({{"core/axle.h", axle}, {"core/turn.h", through}, {"core/wheel.h", wheel}}), IsEmpty());

  const std::string declared = "struct Wheel;\nvoid turn(Wheel& wheel);\n";
  EXPECT_THAT(namesNotReached({{"core/turn.h", declared}, {"core/wheel.h", wheel}}), IsEmpty());
}

TEST(ReachedNames, WhatOthersHappenToIncludeIsNotReached) {
  const std::string wheel = "struct Wheel {};\nenum class Spin { left };\nconstexpr int kWheels = 4;\n";
  const std::string axle = "Wheel wheel[kWheels];\nSpin spin;\n";
  EXPECT_THAT(namesNotReached({{"core/axle.h", axle}, {"core/wheel.h", wheel}}),
              ElementsAre("core/axle.h: Spin is not reached", "core/axle.h: Wheel is not reached",
                          "core/axle.h: kWheels is not reached"));
}

TEST(ReachedNames, CommentsMembersAndParametersOfTemplatesAreNoUse) {
  const std::string wheel = "struct Wheel {};\n";
  const std::string other =
      "// a Wheel\ntemplate <class Wheel>\nvoid turn(const Wheel& wheel);\nint count(const char* text = \"Wheel\");\n";
  const std::string member = "struct Car {\n  struct Wheel {};\n  Wheel wheel;\n};\n";
  EXPECT_THAT(namesNotReached({{"core/car.h", member}, {"core/wheel.h", wheel}}), IsEmpty());
  EXPECT_THAT(namesNotReached({{"core/other.h", other}, {"core/wheel.h", wheel}}), IsEmpty());
}

TEST(HiddenNames, ASourceHasNoConstantOfTheNameOfAHeaders) {
  const std::map<std::string, std::string> headers = {{"core/wheel.h", "inline constexpr int kWheels = 4;\n"}};
  EXPECT_THAT(namesHidden(headers, {{"apps/car.cpp", "namespace {\nconstexpr int kWheels = 3;\n}  // namespace\n"}}),
              ElementsAre("apps/car.cpp: kWheels is that of core/wheel.h as well"));
  EXPECT_THAT(namesHidden(headers, {{"apps/car.cpp", "void roll() {\n  constexpr int kWheels = 3;\n}\n"}}), IsEmpty());
  EXPECT_THAT(namesHidden(headers, {{"apps/car.cpp", "int count = kWheels;\n"}}), IsEmpty());
}

}  // namespace
}  // namespace springtower
