#include "core/random.h"
#include "tests/support/program.h"

#include <algorithm>
#include <fstream>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <numeric>

namespace springtower {
namespace {

using Json = nlohmann::ordered_json;

std::vector<std::string> oracle(const std::string& file) {
  std::vector<std::string> lines = linesOf(contentOf(std::string(SPRINGTOWER_TEST_DATA_DIR) + "/oracle/" + file));
  if (lines.empty()) throw std::runtime_error("cannot read the oracle's " + file);
  return lines;
}

bool isPublished(const std::string& line) {
  return Json::parse(line).at("id").get<std::string>().starts_with("published-");
}

bool isClear(const std::string& line) {
  const Json expect = Json::parse(line).at("expect");
  return expect.at("clear").get<bool>() && expect.at("stands").is_boolean();
}

// `count` of some lines, by a seeded draw without repeats, in the order of the file.
std::vector<std::string> sample(const std::vector<std::string>& lines, std::size_t count, std::uint64_t seed) {
  std::vector<std::size_t> order(lines.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  RandomStream random(seed, 0);
  for (std::size_t i = 0; i < count; ++i) {
    const auto drawn = static_cast<std::size_t>(random.uniform() * static_cast<double>(lines.size() - i));
    std::swap(order[i], order[i + drawn]);
  }
  std::sort(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(count));
  std::vector<std::string> drawn;
  for (std::size_t i = 0; i < count; ++i) drawn.push_back(lines[order[i]]);
  return drawn;
}

// Statics decides each clear line by more than 1 mm and 1 degree, some hundred times what a tolerance of 0.05 mm lets a block
// sink or lean: a simulation has no excuse, so every single one has to agree.
void expectAgreement(const std::vector<std::string>& lines, std::vector<std::string> options = {}) {
  const ScratchFolder scratch;
  const std::string path = scratch.file("sample.jsonl");
  {
    std::ofstream file(path);
    for (const std::string& line : lines) file << line << '\n';
  }
  options.insert(options.begin(), {"verdict", path, "--check"});
  const ProgramResult result = runProgram("springtower", options);
  EXPECT_EQ(result.exitCode, 0) << result.error;
  EXPECT_EQ(linesOf(result.output).size(), lines.size());
  // What --check says is not taken on trust: the verdicts themselves are compared as well.
  std::size_t standing = 0;
  std::size_t falling = 0;
  for (const std::string& text : linesOf(result.output)) {
    if (!isClear(text)) continue;
    const Json line = Json::parse(text);
    EXPECT_EQ(line.at("stands"), line.at("expect").at("stands")) << text;
    ++(line.at("expect").at("stands").get<bool>() ? standing : falling);
  }
  EXPECT_GT(standing, 0U) << "a sample without towers that stand tests half";
  EXPECT_GT(falling, 0U) << "a sample without towers that fall tests half";
}

// The report's six configurations and a sixth of the towers of three rows. Of T2 only the form without its top block is clear.
TEST(Oracle, SmallTowersAgree) {
  std::vector<std::string> published;
  std::vector<std::string> others;
  for (const std::string& line : oracle("small.jsonl")) (isPublished(line) ? published : others).push_back(line);
  ASSERT_EQ(published.size(), 7U);
  ASSERT_EQ(others.size(), 343U);
  std::vector<std::string> lines = sample(others, 60, 1);
  lines.insert(lines.begin(), published.begin(), published.end());
  expectAgreement(lines);
}

// Towers with displaced blocks, where no simple rule tells which ones fall.
TEST(Oracle, ShiftedTowersAgree) {
  expectAgreement(sample(oracle("shift.jsonl"), 40, 2));
}

// Sleep must not hold up what falls, nor waking bring down what stands.
TEST(Oracle, AgreesWithoutSleep) {
  std::vector<std::string> lines = sample(oracle("shift.jsonl"), 12, 3);
  const std::vector<std::string> small = sample(oracle("small.jsonl"), 12, 4);
  lines.insert(lines.end(), small.begin(), small.end());
  expectAgreement(lines, {"--no-sleep"});
}

}  // namespace
}  // namespace springtower
