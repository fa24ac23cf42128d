#pragma once

#include "core/output_file.h"

#include <functional>
#include <initializer_list>
#include <iosfwd>
#include <optional>
#include <string>
#include <string_view>

namespace springtower {

/// Makes the folder that option `--out` names, with those above it. Throws InputError where that cannot be, or nothing can be
/// written there.
void makeOutputFolder(const std::string& folder);

/// Writes a whole file of that folder. Throws InputError as OutputFile does.
void writeOutputFile(const std::string& folder, const std::string& name, const std::function<void(std::ostream&)>& write);

/// An option that names a file to write, and the name where it was given.
struct OutputName {
  std::string_view option;
  const std::optional<std::string>* name;
};

/// Throws InputError where two options name one file, however it is written, which they would both write; or where the name of
/// one is that of another with .partial, which is what that file is called until it is whole.
void checkOutputNames(std::initializer_list<OutputName> outputs);

/// A text as a field of a CSV file (RFC 4180).
std::string csvText(std::string_view text);

}  // namespace springtower
