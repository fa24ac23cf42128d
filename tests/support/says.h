#pragma once

#include <algorithm>
#include <gmock/gmock.h>
#include <string>
#include <string_view>

namespace springtower {

/// Matches a text that has the parts of `message` between its dots, one after the other: errors say "PLACE: expected Y, got X",
/// and `says("force: corner: expected ..., got 8")` matches PLACE and X, with any Y. Without dots it is HasSubstr.
MATCHER_P(says, message, std::string(negation ? "does not say \"" : "says \"") + message + '"') {
  constexpr std::string_view kGap = "...";
  const std::string text(arg);
  const std::string wanted(message);
  for (std::size_t at = 0, from = 0; from <= wanted.size();) {
    const std::size_t end = std::min(wanted.find(kGap, from), wanted.size());
    const std::string part = wanted.substr(from, end - from);
    at = text.find(part, at);
    if (at == std::string::npos) return false;
    at += part.size();
    from = end + kGap.size();
  }
  return true;
}

}  // namespace springtower
