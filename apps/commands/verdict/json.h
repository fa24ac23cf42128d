#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>

namespace springtower {

/// Whether a line of a list holds nothing, and is skipped.
bool isBlankLine(std::string_view text);

/// One line of a list of towers. Throws InputError, whose message starts with `where`, for what is no JSON, for a key that one
/// object has twice, and for deeper nesting than any line needs.
nlohmann::ordered_json parseVerdictLine(const std::string& text, const std::string& where);

}  // namespace springtower
