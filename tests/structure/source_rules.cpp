#include "tests/structure/source_rules.h"

#include "tests/structure/reached_names.h"
#include "tests/structure/standard_includes.h"

#include <algorithm>
#include <fstream>
#include <initializer_list>
#include <iterator>
#include <map>
#include <regex>
#include <sstream>
#include <stdexcept>
#include <utility>

namespace springtower {
namespace {

struct Folder {
  std::string_view name;
  std::initializer_list<std::string_view> mayInclude;
};

// core < broadphase, narrowphase < solver < apps, bench; core < scenarios < apps, bench; tests see the apps, whose viewer has
// parts that are tested without a window. The public headers (include) include themselves alone; what is behind them (api) lies
// above solver and scenarios, beside apps; examples see what other projects see.
const Folder kFolders[] = {
    {"core", {"core"}},
    {"broadphase", {"core", "broadphase"}},
    {"narrowphase", {"core", "narrowphase"}},
    {"solver", {"core", "broadphase", "narrowphase", "solver"}},
    {"scenarios", {"core", "scenarios"}},
    {"include", {"include"}},
    {"api", {"core", "solver", "scenarios", "include", "api"}},
    {"apps", {"core", "broadphase", "narrowphase", "solver", "scenarios", "apps"}},
    {"bench", {"core", "broadphase", "narrowphase", "solver", "scenarios", "bench"}},
    {"examples", {"include"}},
    {"tests", {"core", "broadphase", "narrowphase", "solver", "scenarios", "include", "api", "apps", "tests"}},
};

// The rooms of the top-level folders that have some, from the ground up: each may include those before it in its own folder.
// docs/adr/0001-folders.md says why in this order.
constexpr std::string_view kRooms[] = {"core",
                                       "core/geometry",
                                       "core/scene",
                                       "scenarios",
                                       "scenarios/recorded",
                                       "narrowphase/exact",
                                       "narrowphase",
                                       "solver/block",
                                       "solver/algebra",
                                       "solver/law",
                                       "solver/world",
                                       "solver/contact",
                                       "solver/explicit",
                                       "solver/implicit",
                                       "solver/rigid",
                                       "solver/sleep",
                                       "solver/reference",
                                       "solver/frame",
                                       "solver/metrics",
                                       "solver/statics",
                                       "solver/hand",
                                       "solver/runner",
                                       "apps/common",
                                       "apps/plot",
                                       "apps/picture",
                                       "apps/commands/run",
                                       "apps/commands/scenes",
                                       "apps/commands/verdict",
                                       "apps/commands/statics",
                                       "apps/commands/profile",
                                       "apps/commands/chart",
                                       "apps/commands/validate",
                                       "apps/commands/settings",
                                       "apps/cli",
                                       "apps/viewer/session",
                                       "apps/viewer/input",
                                       "apps/viewer/view",
                                       "apps/viewer/render",
                                       "apps/viewer/io",
                                       "apps/viewer/ui",
                                       "apps/viewer/app"};

std::string_view topOf(std::string_view path) {
  return path.substr(0, path.find('/'));
}

// Where in the order the room stands that a file lies in, itself or deeper: the number of rooms where it is none of them.
std::ptrdiff_t levelOf(std::string_view folder) {
  while (true) {
    const auto* found = std::find(std::begin(kRooms), std::end(kRooms), folder);
    const size_t end = folder.rfind('/');
    if (found != std::end(kRooms) || end == std::string_view::npos) return found - std::begin(kRooms);
    folder = folder.substr(0, end);
    if (folder == topOf(folder)) return std::ssize(kRooms);  // a new room beside those that have a place
  }
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

// Empty when one room of a folder may include the other, else why not. A folder without rooms has no order; nor have files that
// lie beside its rooms, unless they are one themselves.
std::string complaintInFolder(std::string_view path, std::string_view target) {
  const std::string_view top = topOf(path);
  const bool hasRooms =
      std::any_of(std::begin(kRooms), std::end(kRooms), [&](std::string_view room) { return topOf(room) == top; });
  if (!hasRooms || topOf(target) != top) return "";
  const std::string_view from = path.substr(0, path.rfind('/'));
  const std::string_view to = target.substr(0, target.rfind('/'));
  for (const std::string_view folder : {from, to}) {
    if (levelOf(folder) < std::ssize(kRooms)) continue;
    return folder == top ? "" : std::string(folder) + " has no place in the order";
  }
  if (levelOf(to) <= levelOf(from)) return "";
  return std::string(from) + " must not include " + std::string(to);
}

// Public headers are included as they are installed.
constexpr std::string_view kPublicHeaders = "springtower/";

// Empty when the include is allowed in a file of `folder`, else why not.
std::string complaint(std::string_view path, const Folder& folder, const Include& include) {
  const auto& allowed = folder.mayInclude;
  if (include.target.starts_with(kPublicHeaders)) {
    if (include.quoted) return "needs angle brackets: it is a public header";
    if (std::find(allowed.begin(), allowed.end(), "include") != allowed.end()) return "";
    return std::string(folder.name) + " must not include the public headers";
  }
  const Folder* target = include.target.find('/') == std::string_view::npos ? nullptr : findFolder(include.target);
  if (target == nullptr) {
    if (include.quoted) return "is not written from the repository root";
    // The standard library's headers are single words.
    const bool isStandard = include.target.find_first_of("/.") == std::string_view::npos;
    return folder.name == "include" && !isStandard ? "a public header includes the standard library alone" : "";
  }
  if (target->name == "include") return "is written <springtower/...>: it is a public header";
  if (!include.quoted) return "needs quotes: it is a file of this project";
  if (std::find(allowed.begin(), allowed.end(), target->name) != allowed.end()) return complaintInFolder(path, include.target);
  return std::string(folder.name) + " must not include " + std::string(target->name);
}

// Functions as clang-format lays them out: their heads begin in a line at the margin, or, of members defined in their type, two
// spaces in; they may go on in lines farther in, end in "{", and are of no namespace, type or table. A "}" at the same margin
// ends them.
class FunctionLengths {
 public:
  // Looks at the next line. Returns the length of the function that it ends, in lines, 0 where it ends none.
  int next(std::string_view line) {
    ++line_;
    const size_t first = line.find_first_not_of(' ');
    if (begin_ != 0) {
      if (first != margin_ || line.substr(first) != "}") return 0;
      return line_ - std::exchange(begin_, 0) + 1;
    }
    if (first == 0 || first == 2) {
      head_ = line_;
      margin_ = first;
      isFunction_ = mayBeginFunction(line.substr(first));
    }
    if (first != std::string_view::npos && isFunction_ && endsHead(line)) begin_ = head_;
    return 0;
  }

 private:
  static bool mayBeginFunction(std::string_view line) {
    for (const std::string_view other :
         {"namespace", "struct", "class", "enum", "union", "extern", "if", "for", "while", "switch", "else", "//"}) {
      if (line.starts_with(other)) return false;
    }
    return true;
  }

  static bool endsHead(std::string_view line) {
    for (const std::string_view end : {") {", "const {", "noexcept {", "override {"}) {
      if (line.ends_with(end)) return true;
    }
    return false;
  }

  int line_ = 0;
  int head_ = 0;
  int begin_ = 0;
  size_t margin_ = 0;
  bool isFunction_ = false;
};

// Whether a test writes into the folder for temporary files that all processes share.
bool usesSharedFolder(std::string_view path, std::string_view text) {
  if (!path.starts_with("tests/") || path.starts_with("tests/support/")) return false;
  for (const std::string_view name : {"TempDir", "temp_directory_path"}) {
    if (text.find(std::string(name) + "()") != std::string_view::npos) return true;
  }
  return false;
}

// The folders in which states are decided: see core/elementary.h.
constexpr std::string_view kDeciding[] = {"core", "broadphase", "narrowphase", "solver", "scenarios", "api"};

// What in a line of code has other last bits on another machine: elementary functions of the C library, by whatever spelling,
// what calls them in Eigen, and distributions of the standard library. Empty where there is nothing. A comment is no code.
std::string_view machineDependent(std::string_view line) {
  static const std::regex kPattern(
      R"((\bstd::|[^\w:.>]::|__builtin_|(?:^|[^\w:.>]))(a?(sin|cos|tan)h?|atan2|exp2?|expm1|log(2|10|1p)?|pow|cbrt|hypot|[tl]gamma|erfc?|fma)[fl]?\()"
      R"(|\bstd::(complex|polar)\b|\bstd::\w+_distribution\b|\bAngleAxis[df]?\b|\.(slerp|angularDistance|computeDirect)\()"
      R"(|\.(a?(sin|cos|tan)h?|exp2?|expm1|log(2|10|1p)?|cube_root|cbrt|lgamma|digamma|erfc?|blueNorm)\(\))"
      R"(|\.pow\()");
  line = line.substr(0, line.find("//"));
  std::match_results<std::string_view::const_iterator> found;
  if (!std::regex_search(line.begin(), line.end(), found, kPattern)) return {};
  return line.substr(static_cast<size_t>(found.position()), static_cast<size_t>(found.length()));
}

// Whether a line needs the value of a constant of core/tuning.def at compile time, which the preset `tune` reads from a file.
bool fixesTuning(std::string_view line) {
  line = line.substr(0, line.find("//"));
  const size_t fixed = line.find("constexpr ");
  return fixed != std::string_view::npos && line.find("tuning::", fixed) != std::string_view::npos;
}

bool decidesStates(std::string_view path) {
  if (path.starts_with("core/elementary.")) return false;  // defines functions of these names
  return std::find(std::begin(kDeciding), std::end(kDeciding), topOf(path)) != std::end(kDeciding);
}

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
    const std::string_view inexact = decidesStates(path) ? machineDependent(line) : std::string_view{};
    if (!inexact.empty()) {
      broken.push_back(std::string(path) + ":" + std::to_string(lineNumber) + ": expected functions of core/elementary.h and " +
                       "core/rotation_vector.h, got " + std::string(inexact) + ", whose last bits depend on the machine");
    }
    if (fixesTuning(line)) {
      broken.push_back(std::string(path) + ":" + std::to_string(lineNumber) +
                       ": expected const, got constexpr: the preset tune reads constants of core/tuning.def from a file");
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
  if (path.ends_with(".h")) {
    for (const std::string& name : missingStandardIncludes(text)) broken.push_back(std::string(path) + ": " + name);
  }
  if (usesSharedFolder(path, text)) {
    broken.push_back(std::string(path) + ": files of a test belong in its own ScratchFolder, for tests run side by side");
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
  const auto open = std::count_if(files.begin(), files.end(), [](const auto& file) { return *file.begin() == "include"; });
  if (open > kMaxPublicHeaders) broken.push_back("include/: " + std::to_string(open) + " public headers");
  std::map<std::string, std::string> headers;
  std::map<std::string, std::string> sources;
  for (const std::filesystem::path& file : files) {
    std::ifstream stream(root / file, std::ios::binary);
    std::ostringstream text;
    text << stream.rdbuf();
    if (!stream) throw std::runtime_error("cannot read " + file.string());
    for (std::string& line : brokenRules(file.generic_string(), text.str())) broken.push_back(std::move(line));
    // Public headers have a namespace of their own, and are compiled alone.
    const bool isEngine = *file.begin() != "include" && *file.begin() != "api" && *file.begin() != "examples";
    if (isEngine) (file.extension() == ".h" ? headers : sources).emplace(file.generic_string(), text.str());
  }
  for (std::string& line : namesNotReached(headers)) broken.push_back(std::move(line));
  for (const Folder& folder : kFolders) {
    const auto isOf = [](std::string_view path, std::string_view top) { return topOf(path) == top; };
    std::map<std::string, std::string> within;
    for (const auto& header : headers) {
      const auto& may = folder.mayInclude;
      if (std::any_of(may.begin(), may.end(), [&](std::string_view top) { return isOf(header.first, top); }))
        within.insert(header);
    }
    std::map<std::string, std::string> own;
    for (const auto& [path, text] : sources)
      if (isOf(path, folder.name)) own.emplace(path, text);
    for (std::string& line : namesHidden(within, own)) broken.push_back(std::move(line));
  }
  return broken;
}

}  // namespace springtower
