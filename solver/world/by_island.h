#pragma once

#include "broadphase/islands.h"
#include "core/tuning.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace springtower {

/// One record for each island, found by its smallest block. A record stays while that block is the smallest of an island; those
/// that islands leave are handed to new ones after reset(record), which leaves nothing known and keeps the memory.
template <class Record>
class ByIsland {
 public:
  ByIsland() = default;
  ByIsland(const ByIsland& other) = default;
  ByIsland(ByIsland&& other) noexcept = default;
  ByIsland& operator=(ByIsland&& other) noexcept = default;
  ~ByIsland() = default;
  /// Keeps the memory of records beyond those of `other`, as vectors do.
  ByIsland& operator=(const ByIsland& other) {
    if (this == &other) return *this;
    const std::size_t shared = std::min(records_.size(), other.records_.size());
    std::copy_n(other.records_.begin(), shared, records_.begin());
    for (std::size_t i = shared; i < other.records_.size(); ++i) records_.push_back(other.records_[i]);
    for (std::size_t i = other.records_.size(); i < records_.size(); ++i) reset(records_[i]);
    place_ = other.place_;
    owner_ = other.owner_;
    owner_.resize(records_.size(), kNone);
    return *this;
  }

  /// From here on islands have records, in a scene of so many blocks.
  void use(std::size_t blocks) { place_.assign(blocks, kNone); }
  [[nodiscard]] bool isUsed() const { return !place_.empty(); }

  /// Gives every island a record, and takes those of islands that are gone. Not while islands run.
  void assign(const Islands& islands) {
    if (!isUsed()) return;
    const auto isFirst = [&](std::int32_t block) {
      const std::int32_t island = islands.islandOf[static_cast<std::size_t>(block)];
      return island >= 0 && islands.island(static_cast<std::size_t>(island)).front() == block;
    };
    free_.clear();
    for (std::size_t i = records_.size(); i-- > 0;) {
      if (owner_[i] >= 0 && !isFirst(owner_[i])) {
        place_[static_cast<std::size_t>(owner_[i])] = kNone;
        owner_[i] = kNone;
        reset(records_[i]);
      }
      if (owner_[i] < 0) free_.push_back(static_cast<std::int32_t>(i));
    }
    for (std::size_t i = 0; i < islands.count(); ++i) place(islands.island(i).front());
    while (!owner_.empty() && owner_.back() < 0 && free_.size() > tuning::kSpareIslandRecords) {
      owner_.pop_back();
      records_.pop_back();
      free_.erase(free_.begin());  // the largest, which is the last record
    }
  }

  /// The record of the island with this smallest block. Precondition: assign has seen the island.
  Record& of(std::int32_t first) { return records_[static_cast<std::size_t>(place_[static_cast<std::size_t>(first)])]; }

  [[nodiscard]] const Record& of(std::int32_t first) const {
    return records_[static_cast<std::size_t>(place_[static_cast<std::size_t>(first)])];
  }

  /// As bytes (core/byte_stream.h): every record in its place.
  template <class Stream>
  void transfer(Stream& stream) {
    stream(records_, owner_, place_, free_);
    if constexpr (Stream::kReads) free_.reserve(records_.size());
  }

  std::span<Record> all() { return records_; }
  [[nodiscard]] std::span<const Record> all() const { return records_; }
  /// Bytes of the indices by which records are found.
  [[nodiscard]] std::size_t indexBytes() const { return (place_.size() + owner_.size() + free_.size()) * sizeof(std::int32_t); }

 private:
  static constexpr std::int32_t kNone = -1;

  void place(std::int32_t first) {
    std::int32_t& at = place_[static_cast<std::size_t>(first)];
    if (at >= 0) return;
    if (free_.empty()) {
      at = static_cast<std::int32_t>(records_.size());
      records_.emplace_back();
      owner_.push_back(first);
      free_.reserve(records_.size());
      return;
    }
    at = free_.back();
    free_.pop_back();
    owner_[static_cast<std::size_t>(at)] = first;
  }

  std::vector<Record> records_;
  std::vector<std::int32_t> owner_;  // of each record, the smallest block of its island; -1: none
  std::vector<std::int32_t> place_;  // of each block, its record; -1: none
  std::vector<std::int32_t> free_;   // records without an island, descending
};

}  // namespace springtower
