#include "core/whole_file.h"

#include "core/error.h"

#include <cstddef>
#include <filesystem>
#include <fmt/format.h>
#include <fstream>
#include <ios>
#include <system_error>

namespace springtower {

std::string wholeFile(const std::string& path, const std::string& where, std::size_t most) {
  std::error_code error;
  if (std::filesystem::is_directory(path, error)) throw InputError(where + ": expected a file, got a folder");
  std::ifstream stream(path, std::ios::binary);
  std::string text;
  constexpr std::size_t kChunk = std::size_t{1} << 16U;
  for (std::streamsize got = 1; stream && got > 0;) {
    const std::size_t size = text.size();
    text.resize(size + kChunk);
    got = stream.read(text.data() + size, static_cast<std::streamsize>(kChunk)).gcount();
    text.resize(size + static_cast<std::size_t>(got));
    if (text.size() > most) throw InputError(fmt::format("{}: expected at most {} bytes, got more", where, most));
  }
  if (!stream.eof()) throw InputError(where + ": expected a file that can be read, got one that cannot");
  return text;
}

}  // namespace springtower
