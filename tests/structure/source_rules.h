#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace springtower {

/// The longest file the project allows, in lines: one concept may take what it needs.
inline constexpr int kMaxLines = 800;
/// The longest function, in lines from its first to its closing brace.
inline constexpr int kMaxFunctionLines = 60;
/// The most headers of the public interface: one for each part of it, and one that includes the others.
inline constexpr int kMaxPublicHeaders = 7;
/// The most files that lie in solver/ itself, beside its folders.
inline constexpr int kMaxFlatFiles = 12;

/// What a source file breaks, one line of text each, with the path and the line number; empty when it keeps every rule:
/// an include names its file from the repository root and reaches only the folders below its own and its own (see kFolders in the
/// source); public headers are written as they are installed (<springtower/...>), and include nothing but the standard library
/// and one another; within a folder that has rooms it reaches only the file's own room and those before it (kRooms); a header
/// starts with `#pragma once` and includes what defines the names of the standard library that it uses; no file is longer than
/// kMaxLines and no function longer than kMaxFunctionLines; where states are decided no function is called whose last bits depend
/// on the machine; no line makes a constant at compile time of one of core/tuning.def. `path` is relative to the repository root
/// and starts with the folder whose rules apply; `text` is the content of the file.
std::vector<std::string> brokenRules(std::string_view path, std::string_view text);

/// All C++ files (.h, .cpp) of the project's folders under `root`, relative to it, sorted.
std::vector<std::filesystem::path> sourceFiles(const std::filesystem::path& root);

/// brokenRules() of every file of sourceFiles(root), and folders that hold too many. Throws std::runtime_error when a file cannot
/// be read.
std::vector<std::string> brokenRulesInTree(const std::filesystem::path& root);

}  // namespace springtower
