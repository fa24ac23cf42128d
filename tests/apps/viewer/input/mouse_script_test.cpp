#include "apps/viewer/input/mouse_script.h"

#include "core/error.h"
#include "tests/support/program.h"
#include "tests/support/says.h"

#include <fstream>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace springtower {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

TEST(MouseScript, TheMouseGoesStraightFromStepToStep) {
  const ScratchFolder scratch;
  const std::string path = scratch.file("mouse");
  std::ofstream(path) << "# a drag\n10 100 50\n20 100 50 press\n\n30 200 70\n30 200 70 release\n";
  const std::vector<MouseStep> script = readMouseScript(path);
  ASSERT_EQ(script.size(), 4U);
  EXPECT_EQ(mouseAt(script, 1), Eigen::Vector2d(100, 50));
  EXPECT_EQ(mouseAt(script, 25), Eigen::Vector2d(150, 60));
  EXPECT_EQ(mouseAt(script, 99), Eigen::Vector2d(200, 70));
  EXPECT_THAT(mouseActs(script, 20), ElementsAre(MouseAct::press));
  EXPECT_THAT(mouseActs(script, 30), ElementsAre(MouseAct::release));
  EXPECT_THAT(mouseActs(script, 25), IsEmpty());
}

TEST(MouseScript, SaysWhatIsWrong) {
  const ScratchFolder scratch;
  const std::string path = scratch.file("mouse");
  for (const char* line : {"10 100", "10 100 50 jump", "10 100 50 press 3", "x 1 2", "4 1 2"}) {
    std::ofstream(path) << "5 1 2\n" << line << '\n';
    try {
      readMouseScript(path);
      ADD_FAILURE() << line;
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(), says("mouse, line 2: expected ..., got '" + std::string(line) + "'")) << line;
    }
  }
  for (const auto& [file, expected] :
       {std::pair(scratch.file("none"), std::string("none: expected a file that can be read")),
        std::pair(scratch.file(""), std::string("expected a file, got a folder")),
        std::pair(std::string("/dev/zero"), std::string("/dev/zero, line 1: expected at most 1 MB"))}) {
    try {
      readMouseScript(file);
      ADD_FAILURE() << file;
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(), ::testing::HasSubstr(expected));
    }
  }
}

}  // namespace
}  // namespace springtower
