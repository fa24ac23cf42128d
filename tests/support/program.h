#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace springtower {

/// What a program left behind.
struct ProgramResult {
  int exitCode = -1;  ///< or minus the signal that ended it
  std::string output;
  std::string error;
};

/// Runs a program of this build (`name` in its folder bin) with the arguments as they are, no shell between; `input` is its
/// standard input. Standard output goes to the file or device `output` instead of the result where one is given. Throws
/// std::runtime_error when it cannot be run.
ProgramResult runProgram(std::string_view name, const std::vector<std::string>& arguments, std::string_view input = {},
                         const std::string& output = {});

/// Lines of a text; a last line end does not begin another.
std::vector<std::string> linesOf(const std::string& text);

/// The content of a file, empty when there is none.
std::string contentOf(const std::filesystem::path& path);

/// A new empty folder that vanishes with its content.
class ScratchFolder {
 public:
  ScratchFolder();
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;
  ~ScratchFolder();
  [[nodiscard]] std::string file(std::string_view name) const { return (path_ / name).string(); }
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

}  // namespace springtower
