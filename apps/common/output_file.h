#pragma once

#include "core/output_file.h"

#include <functional>
#include <iosfwd>
#include <string>
#include <string_view>

namespace springtower {

/// Makes the folder that option `--out` names, with those above it. Throws InputError where that cannot be, or nothing can be
/// written there.
void makeOutputFolder(const std::string& folder);

/// Writes a whole file of that folder. Throws InputError as OutputFile does.
void writeOutputFile(const std::string& folder, const std::string& name, const std::function<void(std::ostream&)>& write);

/// A text as a field of a CSV file (RFC 4180).
std::string csvText(std::string_view text);

}  // namespace springtower
