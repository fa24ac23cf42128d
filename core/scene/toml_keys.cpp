#include "core/scene/toml_keys.h"

#include "core/error.h"
#include "core/limits.h"

#include <algorithm>
#include <cstddef>
#include <fmt/format.h>

namespace springtower {
namespace {

constexpr std::size_t kMaxKeyParts = 8;

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

[[noreturn]] void fail(std::string_view text, std::size_t key, const std::string& file) {
  const std::string_view before = text.substr(0, key);
  const auto line = 1 + std::count(before.begin(), before.end(), '\n');
  const std::string_view onLine = before.substr(before.rfind('\n') + 1);
  // As toml++ counts them: characters, not bytes.
  const auto isFirstByte = [](char byte) { return (static_cast<unsigned char>(byte) & 0xC0U) != 0x80U; };
  const auto column = 1 + std::count_if(onLine.begin(), onLine.end(), isFirstByte);
  throw InputError(fmt::format("{}:{}:{}: found a key of more than {} parts, {}, allowed are at most {}", file, line, column,
                               kMaxKeyParts, inQuotes(text.substr(key, text.find('\n', key) - key)), kMaxKeyParts));
}

}  // namespace

void refuseLongKeys(std::string_view text, const std::string& file) {
  // Outside strings and comments dots stand between the parts of a key, and one at most in a number or a time.
  std::size_t key = text.find_first_not_of(" \t");
  std::size_t dots = 0;
  for (std::size_t at = 0; at < text.size();) {
    const char character = text[at];
    if (character == '"' || character == '\'') {
      at = endOfString(text, at);
      continue;
    }
    if (character == '#') {
      at = std::min(text.find('\n', at), text.size());
      continue;
    }
    ++at;
    if (std::string_view("\n=,[]{}").find(character) != std::string_view::npos) {
      key = text.find_first_not_of(" \t", at);
      dots = 0;
    } else if (character == '.' && ++dots == kMaxKeyParts) {
      fail(text, key, file);
    }
  }
}

}  // namespace springtower
