#include "tests/structure/source_rules.h"

#include <algorithm>
#include <fstream>
#include <initializer_list>
#include <iterator>
#include <sstream>
#include <stdexcept>
#include <utility>

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

// The rooms of solver/, from the ground up: each may know those before it. docs/adr/0001-folders.md says why in this order.
constexpr std::string_view kSolverFolders[] = {"block",    "algebra",  "law",     "world", "contact",
                                               "explicit", "implicit", "rigid",   "sleep", "reference",
                                               "frame",    "metrics",  "statics", "hand",  "runner"};
constexpr std::string_view kSolver = "solver/";

// The sub-folder of solver/ that a path lies in; empty where it lies in none.
std::string_view solverFolder(std::string_view path) {
  if (!path.starts_with(kSolver)) return {};
  path.remove_prefix(kSolver.size());
  const size_t end = path.find('/');
  return end == std::string_view::npos ? std::string_view{} : path.substr(0, end);
}

// Where in the order; the number of folders where it is none of them.
std::ptrdiff_t solverLevel(std::string_view folder) {
  return std::find(std::begin(kSolverFolders), std::end(kSolverFolders), folder) - std::begin(kSolverFolders);
}

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

// Empty when one room of solver/ may know the other, else why not.
std::string complaintInSolver(std::string_view path, std::string_view target) {
  const std::string_view from = solverFolder(path);
  const std::string_view to = solverFolder(target);
  if (from.empty() || to.empty()) return "";
  for (const std::string_view folder : {from, to}) {
    if (solverLevel(folder) == std::ssize(kSolverFolders)) return "solver/" + std::string(folder) + " has no place in the order";
  }
  if (solverLevel(to) <= solverLevel(from)) return "";
  return "solver/" + std::string(from) + " must not know solver/" + std::string(to);
}

// Empty when the include is allowed in a file of `folder`, else why not.
std::string complaint(std::string_view path, const Folder& folder, const Include& include) {
  const Folder* target = include.target.find('/') == std::string_view::npos ? nullptr : findFolder(include.target);
  if (target == nullptr) {
    return include.quoted ? "is not written from the repository root" : "";
  }
  if (!include.quoted) return "needs quotes: it is a file of this project";
  const auto& allowed = folder.mayInclude;
  if (std::find(allowed.begin(), allowed.end(), target->name) != allowed.end()) return complaintInSolver(path, include.target);
  return std::string(folder.name) + " must not know " + std::string(target->name);
}

// Functions as clang-format lays them out: they begin in a line at the margin that ends in "{" and is no namespace, type or
// table, and end with a "}" at the margin. Members defined in their type stand two spaces in, and are told by their brackets.
class FunctionLengths {
 public:
  // Looks at the next line. Returns the length of the function that it ends, in lines, 0 where it ends none.
  int next(std::string_view line) {
    ++line_;
    if (begin_ == 0) {
      if (beginsFunction(line)) begin_ = line_;
      margin_ = line.substr(0, line.find_first_not_of(' '));
      return 0;
    }
    if (!line.starts_with(margin_) || line.substr(margin_.size()) != "}") return 0;
    return line_ - std::exchange(begin_, 0) + 1;
  }

 private:
  static bool beginsFunction(std::string_view line) {
    const size_t first = line.find_first_not_of(' ');
    if (first == std::string_view::npos || (first != 0 && first != 2) || !line.ends_with('{')) return false;
    line.remove_prefix(first);
    for (const std::string_view other :
         {"namespace", "struct", "class", "enum", "union", "extern", "if", "for", "while", "switch", "else"}) {
      if (line.starts_with(other)) return false;
    }
    return line.ends_with(") {") || line.ends_with("const {") || line.ends_with("noexcept {") || line.ends_with(") override {");
  }

  int line_ = 0;
  int begin_ = 0;
  std::string margin_;
};

}  // namespace

std::vector<std::string> brokenRules(std::string_view path, std::string_view text) {
  const Folder* folder = findFolder(path);
  if (folder == nullptr) throw std::runtime_error("not in a folder of the project: " + std::string(path));
  std::vector<std::string> broken;
  int lineNumber = 0;
  FunctionLengths lengths;
  std::string_view rest = text;
  while (!rest.empty()) {
    const size_t end = rest.find('\n');
    const std::string_view line = rest.substr(0, end);
    rest = end == std::string_view::npos ? std::string_view{} : rest.substr(end + 1);
    ++lineNumber;
    const int length = lengths.next(line);
    if (length > kMaxFunctionLines) {
      broken.push_back(std::string(path) + ":" + std::to_string(lineNumber) + ": ends a function of " + std::to_string(length) +
                       " lines, more than " + std::to_string(kMaxFunctionLines));
    }
    const Include include = parseInclude(line);
    if (include.target.empty()) continue;
    const std::string why = complaint(path, *folder, include);
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
  const std::vector<std::filesystem::path> files = sourceFiles(root);
  const auto flat = std::count_if(files.begin(), files.end(), [](const auto& file) { return file.parent_path() == "solver"; });
  if (flat > kMaxFlatFiles) broken.push_back("solver/: " + std::to_string(flat) + " files beside its folders");
  for (const std::filesystem::path& file : files) {
    std::ifstream stream(root / file, std::ios::binary);
    std::ostringstream text;
    text << stream.rdbuf();
    if (!stream) throw std::runtime_error("cannot read " + file.string());
    for (std::string& line : brokenRules(file.generic_string(), text.str())) broken.push_back(std::move(line));
  }
  return broken;
}

}  // namespace springtower
