#include "apps/common/output_file.h"

#include "core/error.h"
#include "core/limits.h"

#include <filesystem>
#include <fmt/format.h>
#include <system_error>

namespace springtower {

void makeOutputFolder(const std::string& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error || !std::filesystem::is_directory(folder)) {
    throw InputError(fmt::format("--out: cannot make the folder {}: {}", inQuotes(folder),
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

std::string csvText(std::string_view text) {
  std::string field = "\"";
  for (const char c : text) {
    if (c == '"') field += '"';
    field += c;
  }
  return field + '"';
}

}  // namespace springtower
