#include "core/limits.h"

#include "core/error.h"

#include <fmt/format.h>

namespace springtower {
namespace {

void append(std::string& text, char character, bool escaped) {
  if (escaped) {
    text += fmt::format("\\x{:02x}", static_cast<unsigned char>(character));
  } else {
    text += character;
  }
}

bool isControl(char character) {
  const auto byte = static_cast<unsigned char>(character);
  return byte < 0x20 || byte == 0x7f;
}

}  // namespace

std::string inQuotes(std::string_view text) {
  constexpr std::size_t kMaxCharacters = 80;
  std::string result = "'";
  for (const char character : text.substr(0, kMaxCharacters)) {
    append(result, character, isControl(character) || static_cast<unsigned char>(character) > 0x7f);
  }
  return result + (text.size() > kMaxCharacters ? "...'" : "'");
}

std::string onOneLine(std::string_view text) {
  std::string result;
  for (const char character : text) append(result, character, isControl(character));
  return result;
}

std::string describe(const Range& range) {
  return fmt::format("{} to {}{}{}", range.least, range.most, range.unit.empty() ? "" : " ", range.unit);
}

void requireInRange(double value, const Range& range, std::string_view where) {
  if (isInside(value, range)) return;
  throw InputError(fmt::format("{}: expected {}, got {}", where, describe(range), value));
}

}  // namespace springtower
