#include "tests/support/program.h"

#include <filesystem>
#include <fstream>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <memory>
#include <nlohmann/json.hpp>
#include <regex>
#include <set>
#include <string>
#include <vector>

namespace springtower {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using ::testing::StartsWith;
using Json = nlohmann::ordered_json;

ProgramResult validate(std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), {"validate", "--oracle", std::string(SPRINGTOWER_TEST_DATA_DIR) + "/oracle", "--scenes",
                                       std::string(SPRINGTOWER_SOURCE_DIR) + "/scenes"});
  return runProgram("springtower", arguments);
}

// The parts that take a second or two, judged as the page judges them.
class ValidateQuick : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = std::make_unique<ScratchFolder>();
    result_ = validate({"--out", folder_->file("page"), "--only", "forces,pull", "--check"});
  }
  static void TearDownTestSuite() { folder_.reset(); }
  static std::string read(const std::string& name) { return contentOf(folder_->path() / "page" / name); }

  inline static std::unique_ptr<ScratchFolder> folder_;
  inline static ProgramResult result_;
};

TEST_F(ValidateQuick, EveryClaimHolds) {
  EXPECT_EQ(result_.exitCode, 0) << result_.output << result_.error;
  const Json json = Json::parse(read("validation.json"));
  EXPECT_EQ(json.at("failed"), 0);
  EXPECT_GT(json.at("passed").get<int>(), 20);
}

TEST_F(ValidateQuick, ThePageSaysWhatTheJsonSays) {
  const Json json = Json::parse(read("validation.json"));
  const std::string page = read("validation.md");
  EXPECT_THAT(page, StartsWith("# Validation"));
  std::size_t claims = 0;
  for (const Json& section : json.at("sections")) {
    EXPECT_THAT(page, HasSubstr("## " + section.at("title").get<std::string>() + "\n"));
    for (const Json& claim : section.at("claims")) {
      const std::string row = "| " + claim.at("claim").get<std::string>() + " | " + claim.at("tolerance").get<std::string>() +
                              " | " + claim.at("measured").get<std::string>() + " | ";
      EXPECT_THAT(page, HasSubstr(row));
      ++claims;
    }
  }
  EXPECT_EQ(claims,
            json.at("passed").get<std::size_t>() + json.at("failed").get<std::size_t>() + json.at("reported").get<std::size_t>());
}

TEST_F(ValidateQuick, FiguresOfThePageAreThere) {
  const std::string page = read("validation.md");
  const std::regex figure(R"(\]\(([a-z_]+)\.svg\))");
  std::size_t figures = 0;
  for (std::sregex_iterator i(page.begin(), page.end(), figure); i != std::sregex_iterator(); ++i) {
    EXPECT_THAT(read((*i)[1].str() + ".svg"), StartsWith("<?xml"));
    EXPECT_GT(read((*i)[1].str() + ".png").size(), 1000U);
    ++figures;
  }
  EXPECT_EQ(figures, 1U);
}

// Each test that the table of requirements names is one of ours.
TEST_F(ValidateQuick, RequirementsNameTestsThatExist) {
  std::set<std::string> tests;
  const std::regex macro(R"(\nTEST(_F|_P)?\((\w+), (\w+)\))");
  for (const auto& entry : fs::recursive_directory_iterator(std::string(SPRINGTOWER_SOURCE_DIR) + "/tests")) {
    if (entry.path().extension() != ".cpp") continue;
    const std::string text = contentOf(entry.path());
    for (std::sregex_iterator i(text.begin(), text.end(), macro); i != std::sregex_iterator(); ++i) {
      tests.insert((*i)[2].str() + "." + (*i)[3].str());
    }
  }
  const std::string page = read("validation.md");
  const std::string table = page.substr(page.find("## The requirements"));
  const std::regex name(R"(`(\w+\.\w+)`)");
  std::size_t named = 0;
  for (std::sregex_iterator i(table.begin(), table.end(), name); i != std::sregex_iterator(); ++i) {
    EXPECT_TRUE(tests.contains((*i)[1].str())) << (*i)[1];
    ++named;
  }
  EXPECT_GT(named, 15U);
  for (const char* number : {"1.1", "1.4", "2.1", "2.9", "3.1", "3.3"}) EXPECT_THAT(table, HasSubstr(std::string("| ") + number));
}

TEST(Validate, RefusesWhatItDoesNotKnow) {
  const ScratchFolder scratch;
  const ProgramResult part = validate({"--out", scratch.file("page"), "--only", "magic"});
  EXPECT_EQ(part.exitCode, 2);
  EXPECT_THAT(part.error, HasSubstr("'magic'"));
  const ProgramResult folder =
      runProgram("springtower", {"validate", "--out", scratch.file("page"), "--oracle", scratch.file("no")});
  const ProgramResult scenes =
      runProgram("springtower", {"validate", "--out", scratch.file("page"), "--scenes", scratch.file("no"), "--oracle",
                                 std::string(SPRINGTOWER_TEST_DATA_DIR) + "/oracle"});
  EXPECT_EQ(scenes.exitCode, 2);
  EXPECT_THAT(scenes.error, HasSubstr("--scenes"));
  EXPECT_EQ(folder.exitCode, 2);
  EXPECT_THAT(folder.error, HasSubstr("--oracle"));
  EXPECT_EQ(validate({}).exitCode, 2) << "--out is needed";
  for (const char* full : {"--full", "--long"}) {
    EXPECT_THAT(validate({"--out", scratch.file("page"), full, "--only", "magic"}).error, HasSubstr("'magic'")) << full;
  }
  const ProgramResult twice = validate({"--out", scratch.file("page"), "--full", "--long"});
  EXPECT_EQ(twice.exitCode, 2);
  EXPECT_THAT(twice.error, ::testing::AllOf(HasSubstr("--full"), HasSubstr("--long")));
  EXPECT_FALSE(fs::exists(scratch.file("page")));
}

// A folder of reference sets in which one file is as given and the others are as they should be.
void writeSets(const fs::path& folder, const std::string& name, const std::string& text) {
  const std::string tower = R"j({"id":"a","config":"(111)","expect":{"stands":true,"clear":true}})j";
  fs::create_directories(folder);
  for (const char* set : {"small", "shift", "loose", "r18"})
    std::ofstream(folder / (std::string(set) + ".jsonl")) << tower << '\n';
  std::ofstream(folder / "removal.jsonl") << R"j({"id":"r","config":"(111)","remove":[],"stands_after":[true]})j" << '\n';
  std::ofstream(folder / name) << text << '\n';
}

ProgramResult validateVerdictsOf(const ScratchFolder& scratch, const fs::path& sets) {
  return runProgram("springtower", {"validate", "--out", scratch.file("page"), "--only", "verdicts", "--oracle", sets.string(),
                                    "--scenes", std::string(SPRINGTOWER_SOURCE_DIR) + "/scenes"});
}

// They were no message and exit code 70.
TEST(Validate, NamesTheFileAndLineOfABrokenReferenceSet) {
  struct Broken {
    const char* file;
    const char* text;
    std::vector<const char*> named;
  };
  const Broken all[] = {
      {"removal.jsonl", R"j({"id":)j", {"removal.jsonl, line 1", "expected a JSON object"}},
      {"removal.jsonl", "\n[]", {"removal.jsonl, line 2", "'[]'"}},
      {"removal.jsonl", R"j({"config":"(111)","remove":[],"stands_after":[true]})j", {"line 1", "expected the key id, got none"}},
      {"removal.jsonl", R"j({"id":5,"config":"(111)","remove":[],"stands_after":[true]})j", {"id", "'5'", "a text"}},
      {"removal.jsonl", R"j({"id":"r","config":"(121)","remove":[],"stands_after":[true]})j", {"config", "(121)"}},
      {"removal.jsonl", R"j({"id":"r","config":"(111)","remove":[],"stands_after":["yes"]})j", {"stands_after", "yes"}},
      {"removal.jsonl", R"j({"id":"r","config":"(111)","remove":[],"stands_after":[]})j", {"stands_after", "got 0", "1"}},
      {"removal.jsonl",
       R"j({"id":"r","config":"(111)","remove":[{"row":0}],"stands_after":[true,true]})j",
       {"remove[0]", "expected the key position, got none"}},
      {"removal.jsonl",
       R"j({"id":"r","config":"(111)","remove":[{"row":1,"position":1}],"stands_after":[true,true]})j",
       {"remove", "row 1, position 1"}},
      {"removal.jsonl", R"j({"id":"r","config":"(111)","remove":"all","stands_after":[true]})j", {"remove", "a list of objects"}},
      {"small.jsonl", R"j({"id":)j", {"small.jsonl: line 1", "expected a JSON object"}},
      {"r18.jsonl", "nothing", {"r18.jsonl: line 1", "expected a JSON object"}},
  };
  for (const Broken& broken : all) {
    const ScratchFolder scratch;
    writeSets(scratch.path() / "sets", broken.file, broken.text);
    const ProgramResult result = validateVerdictsOf(scratch, scratch.path() / "sets");
    EXPECT_EQ(result.exitCode, 2) << broken.text << '\n' << result.error;
    for (const char* named : broken.named) EXPECT_THAT(result.error, HasSubstr(named)) << broken.text;
  }
}

// What is expected of a tower may be anything: where that is no verdict, it is not judged.
TEST(Validate, JudgesNoTowerByWhatIsNoVerdict) {
  const ScratchFolder scratch;
  writeSets(scratch.path() / "sets", "small.jsonl", R"j({"id":"a","config":"(111)","expect":{"stands":"yes","clear":"yes"}})j");
  const ProgramResult result = validateVerdictsOf(scratch, scratch.path() / "sets");
  EXPECT_EQ(result.exitCode, 0) << result.error;
  EXPECT_THAT(result.output, HasSubstr("small: clear verdicts right, sleep on: 0 of 0"));
}

}  // namespace
}  // namespace springtower
