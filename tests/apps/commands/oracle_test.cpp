#include "tests/support/program.h"

#include <algorithm>
#include <gtest/gtest.h>
#include <map>
#include <nlohmann/json.hpp>

namespace springtower {
namespace {

using Json = nlohmann::ordered_json;

std::string oraclePath(const std::string& file) {
  return std::string(SPRINGTOWER_TEST_DATA_DIR) + "/oracle/" + file;
}

std::vector<std::string> oracle(const std::string& file) {
  std::vector<std::string> lines = linesOf(contentOf(oraclePath(file)));
  if (lines.empty()) throw std::runtime_error("cannot read the oracle's " + file);
  return lines;
}

bool isClear(const std::string& line) {
  const Json expect = Json::parse(line).at("expect");
  return expect.at("clear").get<bool>() && expect.at("stands").is_boolean();
}

// Statics decides each clear line by more than 1 mm and 1 degree, some hundred times what a tolerance of 0.05 mm lets a block
// sink or lean: a simulation has no excuse, so every single one has to agree. Sleep must not hold up what falls, nor waking
// bring down what stands.
void expectAgreement(const std::string& file, std::size_t clear, const std::vector<std::string>& options = {}) {
  const std::vector<std::string> lines = oracle(file);
  ASSERT_EQ(std::count_if(lines.begin(), lines.end(), isClear), static_cast<std::ptrdiff_t>(clear));
  std::vector<std::string> arguments = {"verdict", oraclePath(file), "--check"};
  arguments.insert(arguments.end(), options.begin(), options.end());
  const ProgramResult result = runProgram("springtower", arguments);
  EXPECT_EQ(result.exitCode, 0) << result.error;
  EXPECT_EQ(linesOf(result.output).size(), lines.size());
  // What --check says is not taken on trust: the verdicts themselves are compared as well, with the file as it was given.
  std::map<std::string, bool> expected;
  for (const std::string& text : lines) {
    if (!isClear(text)) continue;
    const Json line = Json::parse(text);
    expected[line.at("id").get<std::string>()] = line.at("expect").at("stands").get<bool>();
  }
  ASSERT_EQ(expected.size(), clear) << "each line has a name of its own";
  std::size_t agreeing = 0;
  for (const std::string& text : linesOf(result.output)) {
    const Json line = Json::parse(text);
    const auto known = expected.find(line.at("id").get<std::string>());
    if (known == expected.end()) continue;
    EXPECT_EQ(line.at("stands").get<bool>(), known->second) << text;
    if (line.at("stands").get<bool>() == known->second) ++agreeing;
  }
  EXPECT_EQ(agreeing, clear);
}

// The report's six configurations and all towers of three rows. Of T2 only the form without its top block is clear.
TEST(Oracle, SmallTowersAgree) {
  expectAgreement("small.jsonl", 343);
}

TEST(Oracle, SmallTowersAgreeWithoutSleep) {
  expectAgreement("small.jsonl", 343, {"--no-sleep"});
}

// Towers with displaced blocks, where no simple rule decides which ones fall.
TEST(Oracle, ShiftedTowersAgree) {
  expectAgreement("shift.jsonl", 188);
}

TEST(Oracle, ShiftedTowersAgreeWithoutSleep) {
  expectAgreement("shift.jsonl", 188, {"--no-sleep"});
}

}  // namespace
}  // namespace springtower
