// Plays a kept corpus through a target without libFuzzer, so that any compiler can: PROGRAM FOLDER... or FILE... Each input's
// name is printed before it is played, the last one is to blame where the program ends there. Exit code 2 where there is nothing
// to play.
#include "tests/fuzz/fuzz.h"

#include <algorithm>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <vector>

namespace {

namespace fs = std::filesystem;

std::vector<fs::path> inputsOf(const fs::path& path) {
  if (!fs::is_directory(path)) return {path};
  std::vector<fs::path> files;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(path)) {
    if (entry.is_regular_file()) files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  return files;
}

int playAll(int argc, char** argv) {
  std::size_t played = 0;
  for (int i = 1; i < argc; ++i) {
    for (const fs::path& file : inputsOf(argv[i])) {
      std::printf("%s\n", file.c_str());
      std::fflush(stdout);
      std::ifstream stream(file, std::ios::binary);
      const std::vector<char> content{std::istreambuf_iterator<char>(stream), {}};
      if (!stream) {
        std::fprintf(stderr, "%s: cannot be read\n", file.c_str());
        return 2;
      }
      LLVMFuzzerTestOneInput(reinterpret_cast<const std::uint8_t*>(content.data()), content.size());
      ++played;
    }
  }
  std::printf("%zu inputs played\n", played);
  if (played > 0) return 0;
  std::fprintf(stderr, "expected files, and folders that have some, got none\n");
  return 2;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return playAll(argc, argv);
  } catch (const std::exception& error) {  // of an input, mostly: what a target throws is a fault
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
