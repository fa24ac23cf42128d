#pragma once

#include "core/error.h"
#include "core/limits.h"
#include "core/vector.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <fmt/format.h>
#include <optional>
#include <string>
#include <string_view>
#include <toml++/toml.h>
#include <utility>
#include <vector>

namespace springtower {

/// What a value of a file is, as messages name it.
inline std::string found(const toml::node& node) {
  if (const auto* text = node.as_string()) return "the text " + inQuotes(text->get());
  if (const auto* whole = node.as_integer()) return fmt::format("{}", whole->get());
  if (const auto* number = node.as_floating_point()) return fmt::format("{}", number->get());
  if (const auto* flag = node.as_boolean()) return fmt::format("{}", flag->get());
  if (const auto* array = node.as_array()) return fmt::format("an array of {}", array->size());
  return node.is_table() ? "a table" : "a date or time";
}

/// One table of a file, read by key. Its place in the file ("block[3]") and the place of each value go into the messages. All of
/// it throws InputError.
class Table {
 public:
  // Throws on any key that is neither allowed nor the former name of one that is.
  Table(const toml::table& table, std::string path, const std::string& file, const std::vector<std::string_view>& allowed,
        const std::vector<std::string_view>& former = {})
      : table_(table), path_(std::move(path)), file_(file) {
    for (const auto& [key, value] : table) {
      if (std::find(allowed.begin(), allowed.end(), key.str()) != allowed.end()) continue;
      if (std::find(former.begin(), former.end(), key.str()) != former.end()) continue;
      throw InputError(fmt::format("{}: expected {}{}, got the unknown key {}", placed(key.source().begin, ""),
                                   fmt::join(allowed, ", "), path_.empty() ? "" : " in " + path_, inQuotes(key.str())));
    }
  }

  [[nodiscard]] bool has(std::string_view key) const { return table_.contains(key); }

  // The readers leave the target alone where the key is absent.
  void read(std::string_view key, double& target, const Range& range) const {
    if (const toml::node* node = table_.get(key)) target = number(*node, named(key), range);
  }
  void read(std::string_view key, std::optional<double>& target, const Range& range) const {
    if (const toml::node* node = table_.get(key)) target = number(*node, named(key), range);
  }
  void read(std::string_view key, Vec3& target, const Range& range) const {
    const toml::node* node = table_.get(key);
    if (node == nullptr) return;
    const toml::array* array = node->as_array();
    if (array == nullptr || array->size() != 3) {
      fail(*node, named(key), fmt::format("an array of three numbers from {}", describe(range)));
    }
    for (std::size_t i = 0; i < 3; ++i) {
      target[static_cast<Eigen::Index>(i)] = number((*array)[i], fmt::format("{}[{}]", named(key), i), range);
    }
  }
  // So many vectors, as an array of arrays or as one array of all their numbers.
  template <std::size_t kCount>
  void read(std::string_view key, std::array<Vec3, kCount>& target, const Range& range) const {
    const toml::node* node = table_.get(key);
    if (node == nullptr) return;
    const toml::array* array = node->as_array();
    const bool flat = array != nullptr && array->size() == 3 * kCount;
    if (!flat && (array == nullptr || array->size() != kCount)) failVectors(*node, named(key), kCount, range);
    for (std::size_t v = 0; v < kCount; ++v) {
      const toml::array* one = flat ? array : (*array)[v].as_array();
      if (one == nullptr || (!flat && one->size() != 3)) failVectors((*array)[v], named(key), kCount, range);
      for (std::size_t i = 0; i < 3; ++i) {
        const std::size_t place = flat ? 3 * v + i : i;
        const std::string name = flat ? fmt::format("{}[{}]", named(key), place) : fmt::format("{}[{}][{}]", named(key), v, i);
        target[v][static_cast<Eigen::Index>(i)] = number((*one)[place], name, range);
      }
    }
  }
  template <class Whole>
  void readWhole(std::string_view key, Whole& target, std::int64_t least, std::int64_t most) const {
    const toml::node* node = table_.get(key);
    if (node == nullptr) return;
    const auto* whole = node->as_integer();
    if (whole == nullptr || whole->get() < least || whole->get() > most) {
      fail(*node, named(key), fmt::format("a whole number from {} to {}", least, most));
    }
    target = static_cast<Whole>(whole->get());
  }
  void read(std::string_view key, bool& target) const {
    if (const toml::node* node = table_.get(key)) target = typed<bool>(*node, named(key), "true or false");
  }
  void read(std::string_view key, std::string& target) const {
    if (const toml::node* node = table_.get(key)) target = typed<std::string>(*node, named(key), "a text");
  }

  void require(std::string_view key) const {
    if (has(key)) return;
    throw InputError(fmt::format("{}: expected the key {}, got none", placed(table_.source().begin, path_), key));
  }
  // Where the value of a key stands, for messages. Precondition: the key is present.
  [[nodiscard]] std::string where(std::string_view key) const { return placed(table_.get(key)->source().begin, named(key)); }
  [[nodiscard]] std::string where() const { return placed(table_.source().begin, path_); }

  // Calls `use(subtable)` when the key is present.
  template <class Use>
  void readTable(std::string_view key, const std::vector<std::string_view>& allowed, Use use,
                 const std::vector<std::string_view>& former = {}) const {
    const toml::node* node = table_.get(key);
    if (node == nullptr) return;
    if (!node->is_table()) fail(*node, named(key), fmt::format("a table, [{}]", named(key)));
    use(Table(*node->as_table(), named(key), file_, allowed, former));
  }
  // Calls `use(subtable)` for each of an array of tables, in their order.
  template <class Use>
  void readTables(std::string_view key, const std::vector<std::string_view>& allowed, Use use) const {
    const toml::node* node = table_.get(key);
    if (node == nullptr) return;
    const std::string expected = fmt::format("up to {} tables, each [[{}]]", kMaxBlocks, named(key));
    if (!node->is_array() || node->as_array()->size() > kMaxBlocks) fail(*node, named(key), expected);
    const toml::array& array = *node->as_array();
    for (std::size_t i = 0; i < array.size(); ++i) {
      const std::string name = fmt::format("{}[{}]", named(key), i);
      if (!array[i].is_table()) fail(array[i], name, expected);
      use(Table(*array[i].as_table(), name, file_, allowed));
    }
  }

 private:
  [[nodiscard]] std::string named(std::string_view key) const {
    return path_.empty() ? std::string(key) : fmt::format("{}.{}", path_, key);
  }
  [[nodiscard]] std::string placed(const toml::source_position& place, std::string_view name) const {
    return fmt::format("{}:{}:{}{}{}", file_, place.line, place.column, name.empty() ? "" : ": ", name);
  }
  [[noreturn]] void fail(const toml::node& node, std::string_view name, std::string_view allowed) const {
    throw InputError(fmt::format("{}: expected {}, got {}", placed(node.source().begin, name), allowed, found(node)));
  }
  [[noreturn]] void failVectors(const toml::node& node, const std::string& name, std::size_t count, const Range& range) const {
    fail(node, name, fmt::format("{} arrays of three numbers, or {} numbers, from {}", count, 3 * count, describe(range)));
  }
  [[nodiscard]] double number(const toml::node& node, const std::string& name, const Range& range) const {
    if (!node.is_number()) fail(node, name, "a number from " + describe(range));
    // toml++ gives no double for a whole number beyond 2^53 that is none exactly.
    const auto* whole = node.as_integer();
    const double value = whole != nullptr ? static_cast<double>(whole->get()) : node.as_floating_point()->get();
    if (!isInside(value, range)) fail(node, name, describe(range));
    return value;
  }
  template <class T>
  [[nodiscard]] T typed(const toml::node& node, const std::string& name, std::string_view allowed) const {
    const auto value = node.value_exact<T>();
    if (!value) fail(node, name, allowed);
    return *value;
  }

  const toml::table& table_;
  std::string path_;
  const std::string& file_;
};

}  // namespace springtower
