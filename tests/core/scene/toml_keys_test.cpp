#include "core/scene/toml_keys.h"

#include "core/error.h"
#include "core/processor_time.h"
#include "core/scene/scene.h"
#include "tests/support/program.h"
#include "tests/support/says.h"

#include <fmt/format.h>
#include <fstream>
#include <gmock/gmock.h>
#include <string>

namespace springtower {
namespace {

using testing::AllOf;
using testing::EndsWith;
using testing::HasSubstr;
using testing::StartsWith;

// A table within a table for each part, and more of them than a stack holds when they destroy each other.
constexpr int kVeryMany = 200000;

std::string keyOf(int parts, const std::string& part) {
  std::string key = part;
  for (int i = 1; i < parts; ++i) key += "." + part;
  return key;
}

// What is said of a text that must be refused.
std::string complaintAbout(const std::string& text) {
  try {
    refuseLongKeys(text, "some.toml");
  } catch (const InputError& error) {
    return error.what();
  }
  return "none";
}

// What reading a scene from this text says, if anything.
std::string complaintOfTheReader(const std::string& text) {
  const ScratchFolder folder;
  const std::string path = folder.file("scene.toml");
  std::ofstream(path) << text;
  try {
    sceneFromToml(path);
  } catch (const InputError& error) {
    return error.what();
  }
  return "none";
}

TEST(LongKeys, AreRefusedWhereverASceneFileMayHaveAKey) {
  const std::string key = keyOf(kVeryMany, "a");
  for (const std::string& text : {key + " = 1\n", "[" + key + "]\n", "[[" + key + "]]\n", "x = { " + key + " = 1 }\n",
                                  "x = [\n1.5, { " + key + " = 1 }]\n", key + " = = 1\n", "[" + key + "]\nx = = 1\n"}) {
    EXPECT_THAT(complaintOfTheReader("[tower]\nrows = 1\n" + text),
                HasSubstr(": expected a key of at most 8 parts, got 'a.a.a."));
  }
}

TEST(LongKeys, AreNamedByLineAndColumnInOneLine) {
  const std::string key = keyOf(9, "a");
  EXPECT_EQ(complaintAbout("rows = 1\n" + key + " = 1\n"),
            "some.toml:2:1: expected a key of at most 8 parts, got 'a.a.a.a.a.a.a.a.a = 1'");
  EXPECT_THAT(complaintAbout(" \t" + key + " = 1"), StartsWith("some.toml:1:3: "));
  EXPECT_THAT(complaintAbout("\n[ " + key + " ]"), StartsWith("some.toml:2:3: "));
  EXPECT_THAT(complaintAbout("x = { y = 1.5, " + key + " = 1 }"), StartsWith("some.toml:1:16: "));
  EXPECT_THAT(complaintAbout("x = { \"\xc3\xa9\" = 1, " + key + " = 1 }"), StartsWith("some.toml:1:16: "))
      << "characters, not bytes";
  EXPECT_THAT(complaintAbout(keyOf(kVeryMany, "a") + " = 1"),
              AllOf(HasSubstr(": expected a key of at most 8 parts, got 'a"), EndsWith("...'")));
}

TEST(LongKeys, AreFoundWhateverTheirPartsAndWhateverStandsBefore) {
  for (const char* part : {" a\t", "\"a#\\\"'\"", "'\"#\\'", "\"\"", "''", "1"}) {
    EXPECT_EQ(complaintAbout(keyOf(8, part) + " = 1"), "none") << part;
    EXPECT_THAT(complaintAbout(keyOf(9, part) + " = 1"), StartsWith("some.toml:1:")) << part;
  }
  for (const char* value :
       {R"('a\' # ")", R"("\"" # ')", R"("\\" # ')", "''", R"("")", "'''\n\"\"\"\\'''''", "\"\"\"\n'''\\\"\"\" \"\"\"\"\"",
        "''''a'''", "'''''''", R"("broken off)", "'broken off", "07:32:00.999", "1.5e3 # ' \" ''' \"\"\""}) {
    EXPECT_THAT(complaintAbout("x = " + std::string(value) + "\n" + keyOf(9, "a") + " = 1"),
                HasSubstr(":1: expected a key of at most 8 parts, got '"))
        << value;
  }
}

TEST(LongKeys, AreNoneWhereDotsMakeNoKey) {
  const std::string dots = "a.b.c.d.e.f.g.h.i.j.k";
  for (const char* name :
       {"'{0}'", "\"{0}\"", "\"\\\"{0}\"", "'''\n{0}\n'{0}'''''", "\"\"\"\n{0}\\\"\"\"\"\"\"", "'x' # {0}", "'x' # ' \" {0}"}) {
    const std::string text =
        fmt::format("# .............\nname = {}\ntower.rows = 1\nfriction . coefficient = 0.5 # .............\n",
                    fmt::format(fmt::runtime(name), dots));
    EXPECT_EQ(complaintAbout(text), "none") << text;
    EXPECT_EQ(complaintOfTheReader(text), "none") << text;
  }
  EXPECT_EQ(complaintAbout("x = [1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0]\n"), "none");
  EXPECT_EQ(complaintAbout(""), "none");
}

// toml++ takes more than ten seconds of processor time to find out what is wrong with so much.
TEST(LongKeys, OfOneHugeWordTextOrLineAreRefusedFast) {
  constexpr std::size_t kHuge = std::size_t{128} << 20U;
  const double begin_s = processorTime_s();
  EXPECT_THAT(complaintOfTheReader(std::string(kHuge, 'a')), HasSubstr(":1:1: expected a line of at most 16 MB, got 'aaaa"));
  EXPECT_LT(processorTime_s() - begin_s, 4.0) << "most of it for the file itself";
  EXPECT_THAT(complaintOfTheReader("x = 1\n  " + std::string(1001, 'a') + " = 1"),
              HasSubstr(":2:3: expected a word of at most 1000 characters, got 'aaaa"));
  EXPECT_THAT(complaintOfTheReader("x = " + std::string(2000, '1')),
              HasSubstr(":1:5: expected a word of at most 1000 characters, got '"));
  EXPECT_THAT(complaintOfTheReader("name = \"" + std::string(2 << 20, 'a') + "\"\n"),
              HasSubstr(":1:8: expected a text of at most 1 MB, got '\"aaaa"));
  EXPECT_THAT(complaintOfTheReader("# " + std::string(17 << 20, 'a') + "\n"),
              HasSubstr("expected a line of at most 16 MB, got '"));
  EXPECT_EQ(complaintAbout("# " + std::string(2 << 20, 'a') + "\nname = '" + std::string(1 << 19, 'a') + "'\n"), "none");
  EXPECT_EQ(complaintAbout(std::string(1000, 'a') + "." + std::string(1000, 'a') + " = 1"), "none");
}

// The deepest that passes: a header, and in it inline tables, as many as toml++ allows within each other.
TEST(LongKeys, AsAllowedAreReadHoweverTheyAreNested) {
  const std::string key = keyOf(8, "a");
  std::string text = "[" + key + "]\n" + key + " = ";
  for (int level = 0; level < 250; ++level) text += "{ " + key + " = ";
  text += "1" + std::string(250, '}') + "\n";
  EXPECT_THAT(complaintOfTheReader(text), says("expected name, ..., got the unknown key 'a'"));
}

}  // namespace
}  // namespace springtower
