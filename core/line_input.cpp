#include "core/line_input.h"

#include "core/error.h"
#include "core/limits.h"

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fmt/format.h>
#include <istream>
#include <system_error>

namespace springtower {

bool readLine(std::istream& stream, std::string& line, const std::string& where) {
  line.clear();
  const std::istream::sentry isGood(stream, true);
  if (!isGood) return false;
  std::streambuf& buffer = *stream.rdbuf();
  constexpr auto kEnd = std::istream::traits_type::eof();
  try {
    for (auto byte = buffer.sbumpc(); byte != '\n'; byte = buffer.sbumpc()) {
      if (byte == kEnd) {
        stream.setstate(line.empty() ? std::ios::eofbit | std::ios::failbit : std::ios::eofbit);
        return !line.empty();
      }
      if (line.size() == kMaxLineBytes)
        throw InputError(fmt::format("{}: expected at most {} MB in a line, got more", where, kMaxLineBytes >> 20U));
      line.push_back(std::istream::traits_type::to_char_type(byte));
    }
  } catch (const InputError&) {
    throw;
  } catch (const std::exception&) {  // how a file buffer says that reading failed
    stream.setstate(std::ios::badbit);
    return false;
  }
  return true;
}

LineInput::LineInput(const std::string& path, const std::string& option) : name_(onOneLine(path)) {
  const std::string prefix = option.empty() ? "" : option + ": ";
  std::error_code error;
  if (std::filesystem::is_directory(path, error))
    throw InputError(fmt::format("{}{}: expected a file, got a folder", prefix, name_));
  errno = 0;
  stream_.open(path, std::ios::binary);
  if (stream_.is_open()) return;
  throw InputError(fmt::format("{}{}: expected a file that can be read, got none{}{}", prefix, name_, errno == 0 ? "" : ": ",
                               errno == 0 ? "" : std::strerror(errno)));
}

bool LineInput::next(std::string& line) {
  ++number_;
  if (readLine(stream_, line, where())) return true;
  --number_;
  if (stream_.bad()) throw InputError(fmt::format("{}: expected a file that can be read to its end, got one that cannot", name_));
  return false;
}

std::string LineInput::where() const {
  return fmt::format("{}, line {}", name_, number_);
}

}  // namespace springtower
