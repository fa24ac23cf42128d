#include "core/byte_stream.h"

#include "core/error.h"
#include "core/hash.h"
#include "core/version.h"
#include "core/whole_file.h"

#include <filesystem>
#include <fmt/format.h>
#include <fstream>

namespace springtower {
namespace {

// Changes with whatever is written or read otherwise.
constexpr std::uint32_t kFormat = 4;

constexpr std::size_t kLetters = 16;
constexpr std::size_t kPartBytes = std::size_t{1} << 20U;  // read at a time

struct Kind {
  std::string_view letters;  // the first of the file
  std::string_view name;
  std::string_view origin;
};
constexpr std::array<Kind, 2> kKinds = {
    {{"springtower-run\n", "saved run", "springtower run --save"}, {"springtower-wld\n", "world's snapshot", "Snapshot::bytes"}}};
static_assert(kKinds[0].letters.size() == kLetters && kKinds[1].letters.size() == kLetters);

const Kind& kindOf(SealKind kind) {
  return kKinds[static_cast<std::size_t>(kind)];
}

std::uint64_t checksumOf(std::string_view bytes) {
  Hash hash;
  hash.bytes(bytes.data(), bytes.size());
  return hash.value();
}

[[noreturn]] void refuseSeal(std::string_view source, std::string_view got, std::string_view expected) {
  throw InputError(fmt::format("{}: expected {}, got {}", source, expected, got));
}

void checkLetters(SealKind kind, std::string_view bytes, std::string_view source) {
  const Kind& expected = kindOf(kind);
  const std::string allowed = fmt::format("a {}, as {} writes it", expected.name, expected.origin);
  if (bytes.starts_with(expected.letters)) return;
  if (bytes.empty()) refuseSeal(source, "nothing", allowed);
  for (const Kind& other : kKinds) {
    if (bytes.starts_with(other.letters)) refuseSeal(source, fmt::format("a {}", other.name), allowed);
    if (other.letters.starts_with(bytes)) refuseSeal(source, "a beginning that is cut off", allowed);
  }
  refuseSeal(source, "another kind of file", allowed);
}

// A file is as long as it is; what comes through a pipe might have no end.
void appendRest(std::ifstream& file, const std::string& path, std::string_view source, std::string& bytes) {
  std::error_code error;
  const bool regular = std::filesystem::is_regular_file(path, error);
  std::string part(kPartBytes, '\0');
  while (file) {
    file.read(part.data(), static_cast<std::streamsize>(part.size()));
    bytes.append(part, 0, static_cast<std::size_t>(file.gcount()));
    if (!regular && bytes.size() > kMaxFileBytes)
      refuseSeal(source, "more through a pipe", fmt::format("at most {} MB, or a file", kMaxFileBytes >> 20U));
  }
  if (file.bad()) refuseSeal(source, "one that cannot be read to its end", "a file that springtower has written");
}

}  // namespace

void ByteReader::raw(void* into, std::size_t size) {
  if (size > left_.size()) refuse("an end before all was read", "a file that is whole");
  std::memcpy(into, left_.data(), size);
  left_.remove_prefix(size);
}

std::size_t ByteReader::count() {
  std::uint64_t size = 0;
  raw(&size, sizeof size);
  if (size > left_.size()) refuse(fmt::format("one of {}", size), fmt::format("a list that fits in {} bytes", left_.size()));
  return size;
}

void ByteReader::refuse(std::string_view got, std::string_view expected) const {
  refuseSeal(source_, got, expected);
}

void ByteReader::end() const {
  if (!left_.empty()) refuse(fmt::format("{} bytes", left_.size()), "nothing behind the end");
}

std::string sealed(SealKind kind, std::string_view payload) {
  ByteWriter writer;
  writer.raw(kindOf(kind).letters.data(), kLetters);
  writer(kFormat, std::string(kVersion), std::string(kGitCommit), static_cast<std::uint64_t>(payload.size()));
  writer.raw(payload.data(), payload.size());
  writer(checksumOf(writer.bytes()));
  return writer.bytes();
}

Unsealed unsealed(SealKind kind, std::string_view bytes, std::string_view source) {
  checkLetters(kind, bytes, source);
  ByteReader reader(bytes.substr(kLetters), source);
  std::uint32_t format = 0;
  reader(format);
  if (format != kFormat) refuseSeal(source, fmt::format("{}", format), fmt::format("format {}", kFormat));
  std::string version;
  Unsealed result;
  std::uint64_t size = 0;
  reader(version, result.commit, size);
  // Counted as it was written: letters, format, two texts with their lengths, length.
  const std::uint64_t head = kLetters + sizeof format + 3 * sizeof size + version.size() + result.commit.size();
  constexpr std::uint64_t kChecksumBytes = sizeof(std::uint64_t);
  const std::uint64_t room = bytes.size() - head;
  if (room < kChecksumBytes || size > room - kChecksumBytes)
    refuseSeal(source, fmt::format("{} bytes, cut off", bytes.size()), "a file that is whole");
  if (size < room - kChecksumBytes)
    refuseSeal(source, fmt::format("{} bytes", room - kChecksumBytes - size), "nothing behind the end");
  std::uint64_t checksum = 0;
  std::memcpy(&checksum, bytes.data() + head + size, sizeof checksum);
  if (checksum != checksumOf(bytes.substr(0, head + size)))
    refuseSeal(source, "other bytes than were written (their checksum differs)", "a file as it was written");
  if (version != kVersion)
    refuseSeal(source, fmt::format("one of version {}", version), fmt::format("one of version {}", kVersion));
  result.payload = bytes.substr(head, size);
  return result;
}

Unsealed unsealedFile(SealKind kind, const std::string& path, std::string_view source) {
  std::ifstream file(path, std::ios::binary);
  std::string bytes(kLetters, '\0');
  if (file) file.read(bytes.data(), kLetters);
  if (!file && file.gcount() == 0 && !file.eof())
    refuseSeal(source, "none that can be read", "a file that springtower has written");
  bytes.resize(static_cast<std::size_t>(file.gcount()));
  checkLetters(kind, bytes, source);
  appendRest(file, path, source, bytes);
  return unsealed(kind, bytes, source);
}

}  // namespace springtower
