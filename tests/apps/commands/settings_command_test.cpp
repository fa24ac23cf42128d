#include "core/settings.h"
#include "tests/support/program.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace springtower {
namespace {

using ::testing::EndsWith;
using ::testing::SizeIs;
using ::testing::StartsWith;
using Json = nlohmann::ordered_json;

TEST(SettingsCommand, ListsEverySettingWithItsFormerName) {
  const ProgramResult result = runProgram("springtower", {"settings"});
  ASSERT_EQ(result.exitCode, 0) << result.error;
  const std::vector<std::string> lines = linesOf(result.output);
  ASSERT_THAT(lines, SizeIs(1 + settingTable().size()));
  for (std::size_t i = 0; i < settingTable().size(); ++i) {
    const SettingRow& row = settingTable()[i];
    const std::string_view former = formerKeyOf(row.key);
    EXPECT_THAT(lines[1 + i], StartsWith(std::string(row.key) + " "));
    EXPECT_THAT(lines[1 + i], EndsWith(fmt::format("{}{}{}", row.reason, former.empty() ? "" : "; formerly ", former)));
  }
}

TEST(SettingsCommand, JsonHasTheFormerNameOrNull) {
  const ProgramResult result = runProgram("springtower", {"settings", "--json"});
  ASSERT_EQ(result.exitCode, 0) << result.error;
  std::size_t renamed = 0;
  const Json json = Json::parse(result.output);
  for (const Json& row : json.at("settings")) {
    const std::string_view former = formerKeyOf(row.at("key").get<std::string>());
    EXPECT_EQ(row.at("formerly"), former.empty() ? Json(nullptr) : Json(former)) << row.at("key");
    renamed += former.empty() ? 0 : 1;
  }
  EXPECT_EQ(renamed, settingAliases().size());
}

}  // namespace
}  // namespace springtower
