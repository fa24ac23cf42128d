// Scenes of which not a bit may move without notice: whoever rearranges the engine proves by them that it does what it did.
#include "scenarios/recorded/recorded_game.h"
#include "tests/pinned/pin.h"

#include <algorithm>
#include <fmt/format.h>
#include <fstream>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <set>

namespace springtower {
namespace {

const Pins& pinsOfFile() {
  static const Pins pins = readPins(SPRINGTOWER_TEST_DATA_DIR "/pinned.json");
  return pins;
}

// Where two runs of a scene part, one line each; empty where they do not.
std::string difference(const Pin& expected, const Pin& found, int frames) {
  std::string text;
  const auto parted = std::mismatch(expected.hashes.begin(), expected.hashes.end(), found.hashes.begin(), found.hashes.end());
  if (expected.hashes.size() != found.hashes.size()) {
    text += fmt::format("{} hashes, {} are pinned\n", found.hashes.size(), expected.hashes.size());
  }
  if (parted.first != expected.hashes.end() && parted.second != found.hashes.end()) {
    const auto first = static_cast<std::size_t>(parted.first - expected.hashes.begin());
    const int last = frameOfHash(first, frames);
    const int from = first == 0 ? 1 : frameOfHash(first - 1, frames) + 1;
    text += fmt::format("parts in frames {} to {}: {:016x}, pinned is {:016x}\n", from, last, *parted.second, *parted.first);
  }
  for (const NamedCounter& counter : kNamedCounters) {
    const std::uint64_t pinned = expected.counters.*counter.member;
    const std::uint64_t now = found.counters.*counter.member;
    if (now != pinned) text += fmt::format("{}: {}, pinned is {}\n", counter.name, now, pinned);
  }
  return text;
}

class PinnedTest : public ::testing::TestWithParam<PinnedScene> {};

void expectPinned(const PinnedScene& scene, int threads, Played how) {
  const auto pinned = pinsOfFile().find(scene.name);
  ASSERT_NE(pinned, pinsOfFile().end()) << "not pinned yet; springtower_pinned_tests --update FILE pins all";
  EXPECT_EQ(difference(pinned->second, pinOf(scene, threads, how), scene.frames), "");
}

TEST_P(PinnedTest, OneThread) {
  expectPinned(GetParam(), 1, Played::atOnce);
}

// At the same time nothing is read from frame to frame but what is of the state or the memo: all else is NaN as a frame begins.
TEST_P(PinnedTest, FourThreadsWithScratchOfNaN) {
  expectPinned(GetParam(), 4, Played::poisoned);
}

// A snapshot written as bytes and read again holds all that the next frames depend on, whatever the method and the scene.
TEST_P(PinnedTest, TwoThreadsSavedAndResumed) {
  expectPinned(GetParam(), 2, Played::savedAndResumed);
}

INSTANTIATE_TEST_SUITE_P(Scenes, PinnedTest, ::testing::ValuesIn(pinnedScenes()),
                         [](const auto& test) { return test.param.name; });

TEST(Pins, AreOfTheScenesThereAre) {
  std::set<std::string> scenes;
  for (const PinnedScene& scene : pinnedScenes()) EXPECT_TRUE(scenes.insert(scene.name).second) << scene.name << " twice";
  std::set<std::string> pinned;
  for (const auto& [name, pin] : pinsOfFile()) pinned.insert(name);
  EXPECT_EQ(pinned, scenes);
}

// After 50 frames of the fall the state of the 30th comes back.
TEST(Pins, OfARestoredFallRepeatThemselves) {
  const std::vector<std::uint64_t>& hashes = pinsOfFile().at("RestoredFall").hashes;
  ASSERT_EQ(hashes.size(), 8U);
  EXPECT_NE(hashes[3], hashes[2]);
  EXPECT_EQ(hashes[5], hashes[3]);
  EXPECT_EQ(hashes[6], hashes[4]);
  EXPECT_NE(hashes[7], hashes[3]);
}

// Blocks that fall meet others than those they stood on; 18 rows that stand have 156 contacts.
TEST(Pins, OfFallsAreOfWhatFalls) {
  for (const char* fall : {"CollapseAndBack", "RestoredFall"})
    EXPECT_GT(pinsOfFile().at(fall).counters.contactsCreated, 300U) << fall;
}

// The same bits as where instructions are counted.
TEST(Pins, OfGatesAreThoseOfTheCountedScenes) {
  std::ifstream file(SPRINGTOWER_SOURCE_DIR "/bench/baseline.json");
  const nlohmann::json counted = nlohmann::json::parse(file).at("scenes");
  for (const char* scene : {"Rest", "Uneven", "Pull", "Collapse"}) {
    for (const bool isImplicit : {true, false}) {
      std::string name = scene;
      name[0] = static_cast<char>(name[0] - 'A' + 'a');
      const std::string hash = counted.at(name + (isImplicit ? " implicit" : " semi-implicit-euler")).at("state_hash");
      const Pin& pin = pinsOfFile().at(fmt::format("Gate{}{}", scene, isImplicit ? "Implicit" : "Explicit"));
      EXPECT_EQ(fmt::format("{:016x}", pin.hashes.back()), hash) << name;
    }
  }
}

TEST(Pins, OfTheRecordedGameAreThoseOfItsCountedParts) {
  std::ifstream file(SPRINGTOWER_SOURCE_DIR "/bench/baseline.json");
  const nlohmann::json counted = nlohmann::json::parse(file).at("scenes");
  const std::vector<std::uint64_t>& hashes = pinsOfFile().at("RecordedGame").hashes;
  for (const GamePart& part : gameParts()) {
    ASSERT_EQ(part.last % kFramesAPin, 0U) << part.name;
    const std::string hash = counted.at(std::string(part.name) + " implicit").at("state_hash");
    EXPECT_EQ(fmt::format("{:016x}", hashes.at(part.last / kFramesAPin - 1)), hash) << part.name;
  }
}

}  // namespace

}  // namespace springtower
