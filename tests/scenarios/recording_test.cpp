// What a recording may hold, and what is said of one that is wrong.
#include "scenarios/recorded/recording.h"

#include "core/error.h"
#include "tests/support/program.h"
#include "tests/support/says.h"

#include <fmt/format.h>
#include <fstream>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <map>
#include <sstream>
#include <string>
#include <utility>

namespace springtower {
namespace {

using ::testing::HasSubstr;

TEST(Recording, BrokenFilesNameTheLine) {
  const ScratchFolder scratch;
  const std::string path = scratch.file("recording.jsonl");
  const std::string head = R"({"springtower_recording":1,"scene":"tower:1","players":0})";
  const std::pair<std::string, std::string> broken[] = {
      {"", "empty"},
      {R"({"scene":"tower:1"})", "line 1"},
      {R"({"springtower_recording":1,"scene":"tower:1","players":0,"seed":1e3000})", "recording.jsonl, line 1: "},
      {head + "\n{\"hash\":\"0\",\"tuning\":{\"friction\":-1e400}}", "recording.jsonl, line 2: "},
      {head + "\n{\"hash\":\"zz\"}", "line 2: hash"},
      {head + "\n[1]", "line 2: expected an object, got an array"},
      {head + "\n{\"hash\":\"0\"}\nnonsense", "line 3"},
      {head + "\n" + R"({"hash":"0","hand":{"block":3,"place":[0,0,0],"turn":[1,0,0,0],"limit_n":5}})",
       "expected a whole number from 0 to 2, got 3"}};
  for (const auto& [text, expected] : broken) {
    std::ofstream(path) << text;
    try {
      readRecording(path);
      ADD_FAILURE() << text;
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(), HasSubstr(expected));
    }
  }
  EXPECT_THROW(readRecording(scratch.file("none")), InputError);
}

struct BadRecording {
  const char* name;
  const char* key;    // of the header, or of the hand or the tuning of the first frame
  const char* value;  // in place of a good one
  const char* found;  // part of what must be said
};

class RecordingNumbers : public ::testing::TestWithParam<BadRecording> {};

// A number that is no whole one, or no number at all, is undefined where it is cast.
TEST_P(RecordingNumbers, AreChecked) {
  std::map<std::string, std::string> values = {
      {"players", "0"},         {"seed", "1"},         {"heights_sigma_m", "0"},
      {"mass_sigma_kg", "0"},   {"start_gap_m", "0"},  {"scene_bytes", "[116,111,119,101,114,58,49]"},
      {"tolerance_m", "5e-05"}, {"friction", "0.4"},   {"block", "2"},
      {"place", "[0,0,0.01]"},  {"turn", "[1,0,0,0]"}, {"limit_n", "5"}};
  const auto write = [&](const std::string& path) {
    const auto pair = [&](const std::string& key) { return fmt::format("\"{}\":{}", key, values.at(key)); };
    std::ofstream(path) << fmt::format(
        "{{\"springtower_recording\":1,\"scene\":\"tower:1\",{},{},{},{},{},{}}}\n{{\"hash\":\"1\",\"tuning\":{{"
        "\"method\":\"implicit\",\"sleep\":\"on\",{},{}}},\"hand\":{{{},{},{},{}}}}}\n",
        pair("players"), pair("seed"), pair("heights_sigma_m"), pair("mass_sigma_kg"), pair("start_gap_m"), pair("scene_bytes"),
        pair("tolerance_m"), pair("friction"), pair("block"), pair("place"), pair("turn"), pair("limit_n"));
  };
  const ScratchFolder scratch;
  const std::string path = scratch.file("recording.jsonl");
  write(path);
  EXPECT_EQ(readRecording(path).frames.size(), 1U);
  const BadRecording& bad = GetParam();
  values.at(bad.key) = bad.value;
  write(path);
  try {
    readRecording(path);
    ADD_FAILURE() << bad.key << ": " << bad.value;
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), testing::StartsWith(path + ", line "));
    EXPECT_THAT(error.what(), HasSubstr(bad.key));
    EXPECT_THAT(error.what(), says(bad.found));
  }
}

INSTANTIATE_TEST_SUITE_P(
    All, RecordingNumbers,
    ::testing::Values(
        BadRecording{"PlayersFloat", "players", "1e300", "expected a whole number from 0 to 4, got 1e+300"},
        BadRecording{"PlayersNegative", "players", "-5", "got -5"}, BadRecording{"PlayersMany", "players", "100000", "100000"},
        BadRecording{"PlayersText", "players", "\"2\"", "got '\"2\"'"}, BadRecording{"SeedFloat", "seed", "1e300", "got 1e+300"},
        BadRecording{"SeedNegative", "seed", "-1", "got -1"},
        BadRecording{"SeedHuge", "seed", "18446744073709551615", "got 18446744073709551615"},
        BadRecording{"HeightsSigma", "heights_sigma_m", "1", "expected ..., got 1"},
        BadRecording{"MassSigma", "mass_sigma_kg", "-1", "got -1"}, BadRecording{"StartGap", "start_gap_m", "null", "got 'null'"},
        BadRecording{"NoByte", "scene_bytes", "[256]", "expected a whole number from 0 to 255, got 256"},
        BadRecording{"NoBytes", "scene_bytes", "{}", "got an object"},
        BadRecording{"Tolerance", "tolerance_m", "-1", "expected ..., got -1"},
        BadRecording{"ToleranceText", "tolerance_m", "\"1\"", "got '\"1\"'"},
        BadRecording{"Friction", "friction", "11", "got 11"}, BadRecording{"BlockFloat", "block", "1e300", "got 1e+300"},
        BadRecording{"BlockNotThere", "block", "3", "expected a whole number from 0 to 2, got 3"},
        BadRecording{"Place", "place", "[0,0,1e308]", "got 1e+308"}, BadRecording{"PlaceShort", "place", "[0,0]", "got an array"},
        BadRecording{"TurnZero", "turn", "[0,0,0,0]", "length of the quaternion"},
        BadRecording{"TurnNotUnit", "turn", "[1,0.1,0,0]", "length of the quaternion"},
        BadRecording{"LimitNegative", "limit_n", "-5", "got -5"}, BadRecording{"LimitHuge", "limit_n", "1e300", "got 1e+300"},
        BadRecording{"Deep", "limit_n", "[[[[1]]]]", "got an array"}),
    [](const auto& given) { return given.param.name; });

// What is misspelt was left out: a frame without its hand, a hash that nothing was compared with.
TEST(Recording, KeysThatItDoesNotKnowAreRefused) {
  const ScratchFolder scratch;
  const std::string good =
      "{\"springtower_recording\":1,\"scene\":\"tower:1\",\"players\":0}\n{\"hash\":\"1\",\"tuning\":{\"method\":\"implicit\","
      "\"sleep\":\"on\",\"tolerance_m\":5e-05,\"friction\":0.4},\"hand\":{\"block\":2,\"place\":[0,0,0.01],\"turn\":[1,0,0,0],"
      "\"limit_n\":5,\"line\":[1,0,0]}}\n";
  std::ofstream(scratch.file("good")) << good;
  EXPECT_EQ(readRecording(scratch.file("good")).frames.size(), 1U);
  for (const std::string key : {"players", "hash", "tuning", "friction", "hand", "limit_n", "line"}) {
    std::string bad = good;
    bad.replace(bad.find("\"" + key + "\""), key.size() + 2, "\"" + key + "s\"");
    std::ofstream(scratch.file("bad")) << bad;
    EXPECT_THAT([&] { readRecording(scratch.file("bad")); },
                testing::ThrowsMessage<InputError>(says("expected ..., got the unknown key '" + key + "s'")));
  }
}

TEST(Recording, FoldersLongLinesAndBlocksThatAreFixedAreRefused) {
  const ScratchFolder scratch;
  EXPECT_THAT([&] { readRecording(scratch.path().string()); },
              testing::ThrowsMessage<InputError>(HasSubstr("expected a file, got a folder")));
  EXPECT_THAT([&] { readRecording("/dev/zero"); },
              testing::ThrowsMessage<InputError>(HasSubstr("line 1: expected at most 1 MB in a line, got more")));
  std::ofstream(scratch.file("scene.toml"))
      << "[[block]]\ncentre_m = [0, 0, 0.0091]\nfixed = true\n[[block]]\ncentre_m = [0, 0, 0.0273]\n";
  std::ofstream(scratch.file("recording.jsonl")) << fmt::format(
      "{{\"springtower_recording\":1,\"scene\":\"{}\",\"players\":0}}\n"
      "{{\"hash\":\"1\",\"hand\":{{\"block\":0,\"place\":[0,0,0],\"turn\":[1,0,0,0],\"limit_n\":5}}}}\n",
      scratch.file("scene.toml"));
  EXPECT_THAT(
      [&] { readRecording(scratch.file("recording.jsonl")); },
      testing::ThrowsMessage<InputError>(HasSubstr("line 2: block: expected a block that moves, got block 0, which is fixed")));
}

TEST(Recording, HashesMayBeMissing) {
  const ScratchFolder scratch;
  const std::string text = fmt::format("{}{}{{\"hash\":\"00000000000000ff\"}}\n{{}}\n", headerLine({}),
                                       R"({"tuning":{"method":"implicit","sleep":"on","tolerance_m":5e-05,"friction":0.4}})"
                                       "\n");
  std::ofstream(scratch.file("recording.jsonl")) << text;
  const Recording recording = readRecording(scratch.file("recording.jsonl"));
  ASSERT_EQ(recording.frames.size(), 3U);
  EXPECT_FALSE(recording.frames[0].hash);
  EXPECT_EQ(recording.frames[1].hash, 255U);
  EXPECT_FALSE(recording.frames[2].hash);
  std::ostringstream again;
  writeRecording(again, recording);
  EXPECT_EQ(again.str(), text);
}

TEST(Recording, OfABrokenOffFileIsReadUpToThere) {
  const ScratchFolder scratch;
  const std::string path = scratch.file("recording.jsonl");
  std::ofstream(path)
      << R"({"springtower_recording":1,"scene":"tower:1","players":0})"
      << "\n{\"hash\":\"1\",\"tuning\":{\"method\":\"implicit\",\"sleep\":\"on\",\"tolerance_m\":1e-5,\"friction\":0.4}}\n"
      << "{\"hash\":\"2\"}\n{\"hash\":";
  const Recording recording = readRecording(path);
  EXPECT_EQ(recording.frames.size(), 2U);
  EXPECT_THAT(recording.missing, HasSubstr("line 4: the line is cut off; the 2 frames before it"));
}

}  // namespace
}  // namespace springtower
