#pragma once

#include <string>
#include <string_view>

namespace springtower {

/// Throws InputError naming line and column of a key with more parts than any file needs (`tower.offset.row` has three). toml++
/// makes a table of each part and destroys tables by recursion: a key long enough ends the program. Other mistakes are left to
/// toml++ to find.
void refuseLongKeys(std::string_view text, const std::string& file);

}  // namespace springtower
