#include "apps/common/output_file.h"
#include "core/error.h"
#include "tests/support/program.h"

#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <optional>
#include <string>

namespace springtower {
namespace {

bool fit(const std::string& first, const std::string& second) {
  const std::optional<std::string> a = first;
  const std::optional<std::string> b = second;
  const std::optional<std::string> none;
  try {
    checkOutputNames({{"--a", &a}, {"--none", &none}, {"--b", &b}});
  } catch (const InputError&) {
    return false;
  }
  return true;
}

TEST(OutputNames, MustBeOfTwoFiles) {
  const ScratchFolder scratch;
  std::filesystem::create_directory(scratch.file("folder"));
  std::filesystem::create_symlink("missing", scratch.file("link"));
  std::filesystem::create_symlink("folder", scratch.file("way"));
  EXPECT_TRUE(fit(scratch.file("a"), scratch.file("b")));
  EXPECT_TRUE(fit(scratch.file("folder/a"), scratch.file("a")));
  for (const auto& [one, other] :
       {std::pair("a", "a"), std::pair("a", "folder/../a"), std::pair("link", "missing"), std::pair("way/a", "folder/a"),
        std::pair("a", "a.partial"), std::pair("way/a.partial", "folder/a")}) {
    EXPECT_FALSE(fit(scratch.file(one), scratch.file(other))) << one << ", " << other;
    EXPECT_FALSE(fit(scratch.file(other), scratch.file(one))) << other << ", " << one;
  }
  EXPECT_TRUE(fit("/dev/null", "/dev/../dev/null")) << "no file: it may be written twice";
}

}  // namespace
}  // namespace springtower
