#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace springtower {

/// Names of the standard library that a header uses without including what defines them, one "std::vector needs <vector>" each;
/// empty when it includes all. Looked for are the names of a table, outside comments. What a header includes of the project does
/// not count: a header must not depend on what others happen to include.
std::vector<std::string> missingStandardIncludes(std::string_view text);

}  // namespace springtower
