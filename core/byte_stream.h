#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <iterator>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace springtower {

// Values as bytes, for what one process saves and another goes on with: every bit of every number, in the order of this machine
// (x86-64: the lowest byte first). A type of ours is written member by member: a function
//   template <class Stream> void fieldsOf(Stream& stream, Type& value)
// beside it, which calls stream(member, member, ...), serves both directions; a writer changes nothing. Structured bindings in it
// make a member that is missing an error of the compiler.

/// Writes values, one behind the other.
class ByteWriter {
 public:
  static constexpr bool kReads = false;
  template <class... Value>
  void operator()(const Value&... values);
  void raw(const void* from, std::size_t size) { bytes_.append(static_cast<const char*>(from), size); }
  [[nodiscard]] const std::string& bytes() const { return bytes_; }

 private:
  std::string bytes_;
};

/// Reads them again. What is not as it was written throws InputError, which names `source`.
class ByteReader {
 public:
  static constexpr bool kReads = true;
  ByteReader(std::string_view bytes, std::string_view source) : left_(bytes), source_(source) {}
  template <class... Value>
  void operator()(Value&&... values);
  void raw(void* into, std::size_t size);
  /// The number of elements of a container, of which each has a byte at least.
  std::size_t count();
  /// Throws InputError: what is expected, and what it got in its place.
  [[noreturn]] void refuse(std::string_view got, std::string_view expected) const;
  /// Throws InputError unless all bytes have been read.
  void end() const;

 private:
  std::string_view left_;
  std::string_view source_;
};

/// A container of which only the size outlives a frame: working space. Read, it has zeros in it.
template <class Vector>
struct SizeOf {
  Vector& of;
};
template <class Vector>
SizeOf<Vector> sizeOf(Vector& vector) {
  return {vector};
}

namespace bytes {

template <class Type>
inline constexpr bool kIsVector = false;
template <class Type, class Allocator>
inline constexpr bool kIsVector<std::vector<Type, Allocator>> = true;
template <class Type>
inline constexpr bool kIsArray = std::is_array_v<Type>;
template <class Type, std::size_t kSize>
inline constexpr bool kIsArray<std::array<Type, kSize>> = true;
template <class Type>
inline constexpr bool kIsOptional = false;
template <class Type>
inline constexpr bool kIsOptional<std::optional<Type>> = true;
template <class Type>
inline constexpr bool kIsSizeOf = false;
template <class Type>
inline constexpr bool kIsSizeOf<SizeOf<Type>> = true;
/// Written as they lie in memory.
template <class Type>
inline constexpr bool kIsPlain = (std::is_arithmetic_v<Type> && !std::is_same_v<Type, bool>) || std::is_enum_v<Type>;
template <class Type>
inline constexpr bool kIsEigen = std::is_base_of_v<Eigen::MatrixBase<Type>, Type>;

template <class Stream, class Type>
void transfer(Stream& stream, Type& value);

template <class Stream, class Vector>
void transferSize(Stream& stream, Vector& vector, bool isWorkingSpace) {
  if constexpr (Stream::kReads) {
    constexpr std::uint64_t kMost = std::uint64_t{1} << 36U;
    std::uint64_t size = 0;
    if (isWorkingSpace) {
      stream(size);
      if (size > kMost) stream.refuse("a larger one", "a working space of no more than a machine can have");
    } else {
      size = stream.count();
    }
    vector.clear();
    vector.resize(size);
  } else {
    stream(static_cast<std::uint64_t>(vector.size()));
  }
}

template <class Stream>
void transferFlag(Stream& stream, bool& value) {
  auto byte = static_cast<std::uint8_t>(value);
  stream.raw(&byte, 1);
  if constexpr (Stream::kReads) {
    if (byte > 1) stream.refuse("a yes or no that is neither", "0 or 1");
    value = byte != 0;
  }
}

template <class Stream, class Type>
void transferOptional(Stream& stream, std::optional<Type>& value) {
  bool isThere = value.has_value();
  transferFlag(stream, isThere);
  if constexpr (Stream::kReads) {
    if (isThere)
      value.emplace();
    else
      value.reset();
  }
  if (isThere) transfer(stream, *value);
}

template <class Stream, class Range>
void transferElements(Stream& stream, Range& values) {
  using Element = std::remove_reference_t<decltype(*std::begin(values))>;
  if constexpr (kIsPlain<Element>) {
    if (std::size(values) > 0) stream.raw(std::data(values), std::size(values) * sizeof(Element));
  } else {
    for (auto& value : values) transfer(stream, value);
  }
}

template <class Stream, class Type>
void transfer(Stream& stream, Type& value) {
  if constexpr (kIsPlain<Type>) {
    stream.raw(&value, sizeof value);
  } else if constexpr (std::is_same_v<Type, bool>) {
    transferFlag(stream, value);
  } else if constexpr (kIsEigen<Type>) {
    static_assert(Type::SizeAtCompileTime != Eigen::Dynamic);
    stream.raw(value.data(), sizeof(typename Type::Scalar) * static_cast<std::size_t>(value.size()));
  } else if constexpr (std::is_same_v<Type, Eigen::Quaterniond>) {
    transfer(stream, value.coeffs());
  } else if constexpr (kIsArray<Type>) {
    transferElements(stream, value);
  } else if constexpr (kIsVector<Type> || std::is_same_v<Type, std::string>) {
    transferSize(stream, value, false);
    transferElements(stream, value);
  } else if constexpr (kIsSizeOf<Type>) {
    transferSize(stream, value.of, true);
  } else if constexpr (kIsOptional<Type>) {
    transferOptional(stream, value);
  } else {
    fieldsOf(stream, value);
  }
}

}  // namespace bytes

template <class... Value>
void ByteWriter::operator()(const Value&... values) {
  (bytes::transfer(*this, const_cast<Value&>(values)), ...);  // which only reads them
}

template <class... Value>
void ByteReader::operator()(Value&&... values) {
  (bytes::transfer(*this, values), ...);
}

/// What a sealed text of bytes holds.
enum class SealKind : std::uint8_t { run, world };

/// Bytes with what says that they are whole and of which kind: the kind in letters, a format number, the version and the commit
/// that wrote them, their length, themselves, and a checksum (FNV-1a) of all that.
std::string sealed(SealKind kind, std::string_view payload);

/// What was sealed, and by which commit.
struct Unsealed {
  std::string payload;
  std::string commit;
};

/// Opens a seal. Throws InputError naming `source`, what is expected and what it got for bytes of another kind, format or
/// version, for those that are cut off, go on behind their end, or are other ones than were written.
Unsealed unsealed(SealKind kind, std::string_view bytes, std::string_view source);

/// The same for a file. Nothing more is read of one that does not begin as it should, and through a pipe no more than 256 MB.
Unsealed unsealedFile(SealKind kind, const std::string& path, std::string_view source);

}  // namespace springtower
