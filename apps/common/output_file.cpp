#include "apps/common/output_file.h"

#include "core/error.h"
#include "core/limits.h"

#include <filesystem>
#include <fmt/format.h>
#include <system_error>

namespace springtower {
namespace {

// The file that a name leads to, without links and steps through folders; the name itself of what is no file, as of a terminal,
// which may be named twice, and where it cannot be known.
std::string resolved(const std::string& name) {
  namespace fs = std::filesystem;
  try {
    const std::string path = withoutDanglingLinks(name);
    if (fs::exists(path) && !fs::is_regular_file(path)) return name;
    return fs::weakly_canonical(fs::absolute(path)).string();
  } catch (const fs::filesystem_error&) {
    return name;
  }
}

}  // namespace

void makeOutputFolder(const std::string& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error || !std::filesystem::is_directory(folder)) {
    throw InputError(fmt::format("--out: expected a folder that is there or can be made, got {}: {}", inQuotes(folder),
                                 error ? error.message() : std::string("there is a file of that name")));
  }
  // Better now than after minutes of work. It is never committed, so it leaves nothing behind.
  const OutputFile probe((std::filesystem::path(folder) / ".probe").string(), "--out");
}

void writeOutputFile(const std::string& folder, const std::string& name, const std::function<void(std::ostream&)>& write) {
  OutputFile file((std::filesystem::path(folder) / name).string(), "--out");
  write(file.stream());
  file.commit();
}

void checkOutputNames(std::initializer_list<OutputName> outputs) {
  for (const OutputName* a = outputs.begin(); a != outputs.end(); ++a) {
    for (const OutputName* b = outputs.begin(); b != a; ++b) {
      if (!*a->name || !*b->name) continue;
      const std::string& nameOfA = **a->name;
      const std::string& nameOfB = **b->name;
      if (nameOfA == nameOfB)
        throw InputError(fmt::format("{} and {}: expected two names, got {} for both", b->option, a->option, inQuotes(nameOfA)));
      const std::string fileOfA = resolved(nameOfA);
      const std::string fileOfB = resolved(nameOfB);
      if (fileOfA == fileOfB)
        throw InputError(fmt::format("{} and {}: expected names of two files, got {} and {}, which are one", b->option, a->option,
                                     inQuotes(nameOfB), inQuotes(nameOfA)));
      if (fileOfA != fileOfB + ".partial" && fileOfB != fileOfA + ".partial") continue;
      throw InputError(
          fmt::format("{} and {}: expected two names of which none is the other with .partial, where that file is "
                      "written until it is whole, got {} and {}",
                      b->option, a->option, inQuotes(nameOfB), inQuotes(nameOfA)));
    }
  }
}

std::string csvText(std::string_view text) {
  std::string field = "\"";
  for (const char c : text) {
    if (c == '"') field += '"';
    field += c;
  }
  return field + '"';
}

}  // namespace springtower
