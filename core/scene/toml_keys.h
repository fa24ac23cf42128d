#pragma once

#include <string>
#include <string_view>

namespace springtower {

/// Throws InputError naming line and column of a key with more parts than any file needs (`tower.offset.row` has three; at most
/// eight are allowed), and of a word (1000 characters), text (1 MB) or line (16 MB) longer than any. toml++ makes a table of each
/// part and destroys tables by recursion: a key long enough ends the program; and it reads a file of one long word for tens of
/// seconds before it finds out. Other mistakes are left to toml++ to find.
void refuseLongKeys(std::string_view text, const std::string& file);

}  // namespace springtower
