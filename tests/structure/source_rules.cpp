#include "tests/structure/source_rules.h"

#include <algorithm>
#include <fstream>
#include <initializer_list>
#include <iterator>
#include <sstream>
#include <stdexcept>

namespace springtower {
namespace {

struct Folder {
  std::string_view name;
  std::initializer_list<std::string_view> mayInclude;
};

// core < broadphase, narrowphase < solver < apps, bench; tests see the apps, whose viewer has parts that are tested without a
// window.
const Folder kFolders[] = {
    {"core", {"core"}},
    {"broadphase", {"core", "broadphase"}},
    {"narrowphase", {"core", "narrowphase"}},
    {"solver", {"core", "broadphase", "narrowphase", "solver"}},
    {"apps", {"core", "broadphase", "narrowphase", "solver", "apps"}},
    {"bench", {"core", "broadphase", "narrowphase", "solver", "bench"}},
    {"tests", {"core", "broadphase", "narrowphase", "solver", "apps", "tests"}},
};

const Folder* findFolder(std::string_view path) {
  const std::string_view name = path.substr(0, path.find('/'));
  const auto* found = std::find_if(std::begin(kFolders), std::end(kFolders), [&](const Folder& f) { return f.name == name; });
  return found == std::end(kFolders) ? nullptr : found;
}

std::string_view skipSpaces(std::string_view text) {
  const size_t first = text.find_first_not_of(" \t");
  return first == std::string_view::npos ? std::string_view{} : text.substr(first);
}

struct Include {
  std::string_view target;  // empty when the line is no include
  bool quoted = false;
};

Include parseInclude(std::string_view line) {
  line = skipSpaces(line);
  if (!line.starts_with('#')) return {};
  line = skipSpaces(line.substr(1));
  if (!line.starts_with("include")) return {};
  line = skipSpaces(line.substr(7));
  const bool quoted = line.starts_with('"');
  if (!quoted && !line.starts_with('<')) return {};
  line.remove_prefix(1);
  return {line.substr(0, line.find(quoted ? '"' : '>')), quoted};
}

// Empty when the include is allowed in `folder`, else why not.
std::string complaint(const Folder& folder, const Include& include) {
  const Folder* target = include.target.find('/') == std::string_view::npos ? nullptr : findFolder(include.target);
  if (target == nullptr) {
    return include.quoted ? "is not written from the repository root" : "";
  }
  if (!include.quoted) return "needs quotes: it is a file of this project";
  const auto& allowed = folder.mayInclude;
  if (std::find(allowed.begin(), allowed.end(), target->name) != allowed.end()) return "";
  return std::string(folder.name) + " must not know " + std::string(target->name);
}

}  // namespace

std::vector<std::string> brokenRules(std::string_view path, std::string_view text) {
  const Folder* folder = findFolder(path);
  if (folder == nullptr) throw std::runtime_error("not in a folder of the project: " + std::string(path));
  std::vector<std::string> broken;
  int lineNumber = 0;
  std::string_view rest = text;
  while (!rest.empty()) {
    const size_t end = rest.find('\n');
    const std::string_view line = rest.substr(0, end);
    rest = end == std::string_view::npos ? std::string_view{} : rest.substr(end + 1);
    ++lineNumber;
    const Include include = parseInclude(line);
    if (include.target.empty()) continue;
    const std::string why = complaint(*folder, include);
    if (why.empty()) continue;
    broken.push_back(std::string(path) + ":" + std::to_string(lineNumber) + ": #include of " + std::string(include.target) +
                     ": " + why);
  }
  if (path.ends_with(".h") && !text.starts_with("#pragma once\n")) {
    broken.push_back(std::string(path) + ":1: a header starts with #pragma once");
  }
  if (lineNumber > kMaxLines) {
    broken.push_back(std::string(path) + ": " + std::to_string(lineNumber) + " lines, more than " + std::to_string(kMaxLines));
  }
  return broken;
}

std::vector<std::filesystem::path> sourceFiles(const std::filesystem::path& root) {
  std::vector<std::filesystem::path> files;
  for (const Folder& folder : kFolders) {
    const std::filesystem::path top = root / folder.name;
    if (!std::filesystem::is_directory(top)) continue;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(top)) {
      const std::filesystem::path extension = entry.path().extension();
      if (entry.is_regular_file() && (extension == ".h" || extension == ".cpp")) {
        files.push_back(std::filesystem::relative(entry.path(), root));
      }
    }
  }
  std::sort(files.begin(), files.end());
  return files;
}

std::vector<std::string> brokenRulesInTree(const std::filesystem::path& root) {
  std::vector<std::string> broken;
  for (const std::filesystem::path& file : sourceFiles(root)) {
    std::ifstream stream(root / file, std::ios::binary);
    std::ostringstream text;
    text << stream.rdbuf();
    if (!stream) throw std::runtime_error("cannot read " + file.string());
    for (std::string& line : brokenRules(file.generic_string(), text.str())) broken.push_back(std::move(line));
  }
  return broken;
}

}  // namespace springtower
