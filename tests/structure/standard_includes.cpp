#include "tests/structure/standard_includes.h"

#include <algorithm>
#include <cctype>
#include <initializer_list>

namespace springtower {
namespace {

struct StandardName {
  std::string_view name;
  std::initializer_list<std::string_view> definedIn;  // any of these will do
};

// Those that headers of this project use. Declarations of streams are enough for references.
const StandardName kNames[] = {
    {"vector", {"vector"}},
    {"array", {"array"}},
    {"span", {"span"}},
    {"string", {"string"}},
    {"to_string", {"string"}},
    {"string_view", {"string_view", "string"}},
    {"optional", {"optional"}},
    {"variant", {"variant"}},
    {"function", {"functional"}},
    {"unique_ptr", {"memory"}},
    {"shared_ptr", {"memory"}},
    {"map", {"map"}},
    {"set", {"set"}},
    {"pair", {"utility", "map"}},
    {"move", {"utility"}},
    {"forward", {"utility"}},
    {"exchange", {"utility"}},
    {"tuple", {"tuple"}},
    {"atomic", {"atomic"}},
    {"mutex", {"mutex"}},
    {"numeric_limits", {"limits"}},
    {"int32_t", {"cstdint"}},
    {"int64_t", {"cstdint"}},
    {"uint8_t", {"cstdint"}},
    {"uint16_t", {"cstdint"}},
    {"uint32_t", {"cstdint"}},
    {"uint64_t", {"cstdint"}},
    {"runtime_error", {"stdexcept"}},
    {"ostream", {"iosfwd", "ostream", "iostream", "sstream", "fstream"}},
    {"istream", {"iosfwd", "istream", "iostream", "sstream", "fstream"}},
    {"ofstream", {"fstream"}},
    {"ifstream", {"fstream"}},
    {"min", {"algorithm"}},
    {"max", {"algorithm"}},
    {"clamp", {"algorithm"}},
    {"sort", {"algorithm"}},
    {"copy_n", {"algorithm"}},
    {"fill_n", {"algorithm"}},
    {"any_of", {"algorithm"}},
    {"all_of", {"algorithm"}},
    {"find_if", {"algorithm"}},
    {"accumulate", {"numeric"}},
    {"iota", {"numeric"}},
    {"sqrt", {"cmath"}},
    {"abs", {"cmath", "cstdlib"}},
    {"ceil", {"cmath"}},
    {"isfinite", {"cmath"}},
    {"memcpy", {"cstring"}},
    {"memcmp", {"cstring"}},
    {"filesystem", {"filesystem"}},
    {"chrono", {"chrono"}},
};

bool isWordCharacter(char c) {
  return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_';
}

// The text without what follows "//" in a line.
std::string withoutComments(std::string_view text) {
  std::string code;
  while (!text.empty()) {
    const std::size_t end = text.find('\n');
    const std::string_view line = text.substr(0, end);
    code += line.substr(0, line.find("//"));
    code += '\n';
    text = end == std::string_view::npos ? std::string_view{} : text.substr(end + 1);
  }
  return code;
}

bool uses(std::string_view code, std::string_view name) {
  const std::string wanted = "std::" + std::string(name);
  for (std::size_t at = code.find(wanted); at != std::string_view::npos; at = code.find(wanted, at + 1)) {
    const std::size_t end = at + wanted.size();
    if (end == code.size() || !isWordCharacter(code[end])) return true;
  }
  return false;
}

bool includes(std::string_view code, std::string_view header) {
  return code.find("#include <" + std::string(header) + ">") != std::string_view::npos;
}

}  // namespace

std::vector<std::string> missingStandardIncludes(std::string_view text) {
  const std::string code = withoutComments(text);
  std::vector<std::string> missing;
  for (const StandardName& name : kNames) {
    if (!uses(code, name.name)) continue;
    const bool found = std::any_of(name.definedIn.begin(), name.definedIn.end(),
                                   [&](std::string_view header) { return includes(code, header); });
    if (!found) missing.push_back("std::" + std::string(name.name) + " needs <" + std::string(*name.definedIn.begin()) + ">");
  }
  return missing;
}

}  // namespace springtower
