#pragma once

#include <cstddef>
#include <string>

namespace springtower {

/// The largest file that is read as a whole: 256 MB.
inline constexpr std::size_t kMaxFileBytes = std::size_t{256} << 20U;
/// The same for results that a program left: 16 MB, as JSON takes many times its text in memory.
inline constexpr std::size_t kMaxResultsBytes = std::size_t{16} << 20U;

/// The whole content of a file, of any bytes. `where` names the file in messages, on one line. Throws InputError "where: expected
/// ..., got ..." when it is a folder, cannot be opened or read to its end, or has more than `most` bytes: a device without an end
/// does not fill the memory.
std::string wholeFile(const std::string& path, const std::string& where, std::size_t most = kMaxFileBytes);

}  // namespace springtower
