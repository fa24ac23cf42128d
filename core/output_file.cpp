#include "core/output_file.h"

#include "core/error.h"
#include "core/limits.h"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fmt/format.h>
#include <system_error>
#include <unistd.h>

namespace springtower {

OutputFile::OutputFile(std::string path, std::string option) : path_(std::move(path)), option_(std::move(option)) {
  namespace fs = std::filesystem;
  std::error_code error;
  const fs::file_status status = fs::status(path_, error);
  if (path_.empty()) fail("an empty name");
  if (fs::is_directory(status)) fail("it is a folder");
  if (fs::exists(status)) {
    if (access(path_.c_str(), W_OK) != 0) fail(std::strerror(errno));
    // A link stays a link: what it points to is replaced.
    if (fs::is_regular_file(status)) path_ = fs::canonical(path_, error).string();
  }
  if (!fs::exists(status) || fs::is_regular_file(status)) {
    partial_ = fmt::format("{}.partial-{}", path_, getpid());
    stream_.open(partial_, std::ios::binary | std::ios::trunc);
    if (stream_.is_open() || !fs::exists(status)) {
      if (!stream_.is_open()) fail(std::strerror(errno));
      return;
    }
    partial_.clear();  // the folder takes no new files, but this one may be written
  }
  stream_.open(path_, std::ios::binary);
  if (!stream_.is_open()) fail(std::strerror(errno));
}

OutputFile::~OutputFile() {
  stream_.close();
  if (!partial_.empty()) std::remove(partial_.c_str());
}

void OutputFile::commit() {
  stream_.close();
  if (stream_.fail()) fail("writing failed; is the disk full?");
  if (partial_.empty()) return;
  if (std::rename(partial_.c_str(), path_.c_str()) != 0) fail(std::strerror(errno));
  partial_.clear();
}

void OutputFile::fail(const std::string& what) const {
  throw InputError(fmt::format("{}: cannot write {}: {}", option_, inQuotes(path_), what));
}

}  // namespace springtower
