#include "core/scene/toml_keys.h"

#include "core/error.h"
#include "core/limits.h"

#include <algorithm>
#include <cstddef>
#include <fmt/format.h>

namespace springtower {
namespace {

constexpr std::size_t kMaxKeyParts = 8;
constexpr std::size_t kMaxWord = 1000;                   // bytes of what is not in quotes: part of a key, number, time
constexpr std::size_t kMaxText = std::size_t{1} << 20U;  // bytes of a text: the code of 2000 rows has 12000
constexpr std::size_t kMaxLine = std::size_t{1} << 24U;  // bytes

// Where a string ends whose opening quote is at `start`: behind its closing quotes, or where it breaks off.
std::size_t endOfString(std::string_view text, std::size_t start) {
  const char quote = text[start];
  const bool hasEscapes = quote == '"';
  const std::string_view three = hasEscapes ? R"(""")" : "'''";
  const bool manyLines = text.substr(start).starts_with(three);
  for (std::size_t at = start + (manyLines ? 3 : 1); at < text.size(); ++at) {
    if (hasEscapes && text[at] == '\\') {
      ++at;
    } else if (!manyLines && text[at] == '\n') {
      return at;
    } else if (!manyLines && text[at] == quote) {
      return at + 1;
    } else if (manyLines && text.substr(at).starts_with(three)) {
      // Up to two quotes before the closing ones belong to the content.
      return std::min(text.find_first_not_of(quote, at), at + 5);
    }
  }
  return text.size();
}

// What is too long begins at `at`, and is shown up to the end of its line.
[[noreturn]] void fail(std::string_view text, std::size_t at, const std::string& file, std::string_view allowed) {
  const std::string_view before = text.substr(0, at);
  const auto line = 1 + std::count(before.begin(), before.end(), '\n');
  const std::string_view onLine = before.substr(before.rfind('\n') + 1);
  // As toml++ counts them: characters, not bytes.
  const auto isFirstByte = [](char byte) { return (static_cast<unsigned char>(byte) & 0xC0U) != 0x80U; };
  const auto column = 1 + std::count_if(onLine.begin(), onLine.end(), isFirstByte);
  throw InputError(fmt::format("{}:{}:{}: expected {}, got {}", file, line, column, allowed,
                               inQuotes(text.substr(at, text.find('\n', at) - at))));
}

// toml++ reads some 10 MB a second, also of what is no scene.
void refuseLongLines(std::string_view text, const std::string& file) {
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    if (end - begin > kMaxLine) fail(text, begin, file, fmt::format("a line of at most {} MB", kMaxLine >> 20U));
    begin = end + 1;
  }
}

}  // namespace

void refuseLongKeys(std::string_view text, const std::string& file) {
  refuseLongLines(text, file);
  // Outside strings and comments dots stand between the parts of a key, and one at most in a number or a time.
  std::size_t key = text.find_first_not_of(" \t");
  std::size_t dots = 0;
  std::size_t word = 0;  // where the present one begins
  for (std::size_t at = 0; at < text.size();) {
    const char character = text[at];
    if (character == '"' || character == '\'') {
      const std::size_t end = endOfString(text, at);
      if (end - at > kMaxText) fail(text, at, file, fmt::format("a text of at most {} MB", kMaxText >> 20U));
      word = at = end;
      continue;
    }
    if (character == '#') {
      word = at = std::min(text.find('\n', at), text.size());
      continue;
    }
    ++at;
    if (std::string_view("\n\r\t =,[]{}.").find(character) != std::string_view::npos) word = at;
    if (at - word > kMaxWord) fail(text, word, file, fmt::format("a word of at most {} characters", kMaxWord));
    if (std::string_view("\n=,[]{}").find(character) != std::string_view::npos) {
      key = text.find_first_not_of(" \t", at);
      dots = 0;
    } else if (character == '.' && ++dots == kMaxKeyParts) {
      fail(text, key, file, fmt::format("a key of at most {} parts", kMaxKeyParts));
    }
  }
}

}  // namespace springtower
