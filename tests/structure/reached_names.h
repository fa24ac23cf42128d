#pragma once

#include <map>
#include <string>
#include <vector>

namespace springtower {

/// Types and constants that a header names although none of the headers that it reaches through its own includes defines or
/// declares them: it would compile only after others. One "path: Name is not reached" each, sorted. `headers`: the texts of all
/// headers of the project by their paths from the repository root. Known are the names at namespace level that begin with a
/// capital (types) or with k and a capital (constants); the compiler itself looks with the option SPRINGTOWER_CHECK_HEADERS,
/// which takes minutes.
std::vector<std::string> namesNotReached(const std::map<std::string, std::string>& headers);

/// Types and constants of this kind that a source defines at namespace level although a header of the project has one of that
/// name: a source that is compiled together with it, or that comes to include the header, would take one for the other. One
/// "path: Name is that of HEADER as well" each, sorted. `sources`: the texts of sources by their paths.
std::vector<std::string> namesHidden(const std::map<std::string, std::string>& headers,
                                     const std::map<std::string, std::string>& sources);

}  // namespace springtower
