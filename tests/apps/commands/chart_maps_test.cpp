// springtower chart --maps, run as a user would.
#include "tests/support/program.h"

#include <algorithm>
#include <filesystem>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <map>
#include <memory>
#include <sstream>
#include <string>
#include <vector>

namespace springtower {
namespace {

using ::testing::HasSubstr;
using Row = std::map<std::string, std::string>;

std::vector<std::string> fieldsOf(const std::string& line) {
  std::vector<std::string> fields;
  std::istringstream stream(line);
  for (std::string field; std::getline(stream, field, ',');) {
    std::erase(field, '"');
    fields.push_back(field);
  }
  return fields;
}

// The quick maps, which the tests below read.
class QuickMaps : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = std::make_unique<ScratchFolder>();
    result_ = runProgram("springtower", {"chart", "--maps", "--quick", "--out", folder_->file("out")});
    const std::vector<std::string> lines = linesOf(contentOf(folder_->file("out/maps.csv")));
    for (std::size_t i = 1; i < lines.size(); ++i) {
      const std::vector<std::string> names = fieldsOf(lines[0]);
      const std::vector<std::string> fields = fieldsOf(lines[i]);
      rows_.emplace_back();
      for (std::size_t f = 0; f < 10; ++f) rows_.back()[names[f]] = fields[f];
    }
  }
  static void TearDownTestSuite() { folder_.reset(); }
  void SetUp() override { ASSERT_EQ(result_.exitCode, 0) << result_.error; }

  static std::vector<Row> of(const std::string& method, const std::string& kind) {
    std::vector<Row> found;
    for (const Row& row : rows_) {
      if (row.at("method") == method && row.at("kind") == kind) found.push_back(row);
    }
    return found;
  }

  inline static std::unique_ptr<ScratchFolder> folder_;
  inline static ProgramResult result_;
  inline static std::vector<Row> rows_;
};

// Theory takes the bound of the largest eigenvalue, which is at most 8 % above it: its root at most 4 %. An unstable step shows
// only once it has grown, and a longer one is only tried where a frame has a whole number of steps.
TEST_F(QuickMaps, BoundariesOfExplicitMethodsAreWhereTheoryPutsThem) {
  for (const char* method : {"semi-implicit-euler", "runge-kutta-4"}) {
    const std::vector<Row> boundary = of(method, "boundary");
    ASSERT_FALSE(boundary.empty()) << method;
    for (const Row& row : boundary) {
      const double ratio = std::stod(row.at("step_s")) / std::stod(row.at("longest_stable_step_s"));
      EXPECT_GT(ratio, 0.8) << method << " with " << row.at("rows") << " rows";
      EXPECT_LT(ratio, 1.2) << method << " with " << row.at("rows") << " rows";
    }
  }
}

TEST_F(QuickMaps, ImplicitStepsHaveNoLimit) {
  EXPECT_TRUE(of("implicit", "boundary").empty());
  EXPECT_FALSE(of("implicit", "grid").empty());
  for (const Row& row : of("implicit", "grid")) EXPECT_NE(row.at("verdict"), "blows up") << row.at("steps_per_frame");
}

TEST_F(QuickMaps, ShowEveryMethod) {
  for (const char* method : {"semi-implicit-euler", "midpoint", "runge-kutta-4", "implicit", "implicit-euler", "report",
                             "rigid-pgs", "rigid-lcp", "xpbd"})
    EXPECT_FALSE(of(method, "grid").empty()) << method;
}

// Springs without dashpots: midpoint's amplitude grows by (w dt)^4 / 8 a step, so what is calm for a while has short steps.
TEST_F(QuickMaps, MidpointNeedsShorterStepsThanRungeKutta) {
  const auto step = [](const Row& row) { return std::stod(row.at("step_s")); };
  const std::vector<Row> midpoint = of("midpoint", "boundary");
  const std::vector<Row> rungeKutta = of("runge-kutta-4", "boundary");
  ASSERT_FALSE(midpoint.empty());
  ASSERT_FALSE(rungeKutta.empty());
  EXPECT_LT(step(std::ranges::max(midpoint, {}, step)), step(std::ranges::min(rungeKutta, {}, step)));
}

TEST(ChartMaps, TimesOutWhatIsTooSlow) {
  const ScratchFolder folder;
  const ProgramResult result = runProgram("springtower", {"chart", "--maps", "--quick", "--methods", "rigid-lcp", "--seconds",
                                                          "5", "--case-limit", "0.01", "--out", folder.file("out")});
  ASSERT_EQ(result.exitCode, 0) << result.error;
  EXPECT_THAT(contentOf(folder.file("out/maps.csv")), HasSubstr("times out"));
}

TEST(ChartMaps, HaveAMethodThatIsNamedTwiceOnce) {
  const ScratchFolder folder;
  const auto points = [&](const std::string& methods) {
    const ProgramResult result = runProgram(
        "springtower", {"chart", "--maps", "--quick", "--methods", methods, "--seconds", "0.2", "--out", folder.file(methods)});
    EXPECT_EQ(result.exitCode, 0) << result.error;
    EXPECT_FALSE(std::filesystem::exists(folder.file(methods + "/maps.unfinished.json")));
    return linesOf(contentOf(folder.file(methods + "/maps.csv"))).size();
  };
  EXPECT_EQ(points("xpbd,xpbd"), points("xpbd"));
}

TEST(ChartMaps, RefuseWhatTheyDoNotUse) {
  const ScratchFolder folder;
  const ProgramResult other = runProgram("springtower", {"chart", "--maps", "--rows", "9", "--out", folder.file("out")});
  EXPECT_EQ(other.exitCode, 2);
  EXPECT_THAT(other.error, HasSubstr("--rows"));
  const ProgramResult peer = runProgram("springtower", {"chart", "--maps", "--methods", "bullet", "--out", folder.file("out")});
  EXPECT_EQ(peer.exitCode, 2);
  EXPECT_THAT(peer.error, HasSubstr("'bullet'"));
}

TEST_F(QuickMaps, AreDrawnAndListed) {
  const std::string index = contentOf(folder_->file("out/maps.md"));
  for (const char* name : {"map_midpoint_stiffness", "map_implicit_rows", "map_xpbd_rows"}) {
    EXPECT_THAT(index, HasSubstr(std::string(name) + ".svg"));
    EXPECT_THAT(contentOf(folder_->file("out/" + std::string(name) + ".png")), HasSubstr("PNG"));
    EXPECT_GT(contentOf(folder_->file("out/" + std::string(name) + ".svg")).size(), 10000U);
  }
}

}  // namespace
}  // namespace springtower
