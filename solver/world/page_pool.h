#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

namespace springtower {

/// Rows of a page, and a column of it.
inline constexpr std::size_t kPageRows = 64;

template <class T>
using Column = std::array<T, kPageRows>;

/// Rows in pages that never move, taken on any thread and returned on one. A page is a structure of arrays of kPageRows rows;
/// `Page` is default constructible and copyable, and `prepare(wide)` adds what wide islands need. No locks: a row is taken by one
/// atomic addition; a page is allocated on the way only if more rows are taken at once than `reserve` provided. Which thread gets
/// which row is not deterministic, so no result may depend on the order of rows. A pool that a copy is assigned to keeps the
/// pages it has.
template <class Page>
class PagePool {
 public:
  PagePool() = default;
  PagePool(const PagePool& other) { *this = other; }
  PagePool& operator=(const PagePool& other) {
    if (this == &other) return *this;
    clear();
    const std::size_t mine = rows_;
    free_ = other.free_;
    rows_ = other.rows_;
    taken_.store(other.taken_.load());
    wide_ = other.wide_;
    settle();
    growTable(other.tableSize_);
    for (std::size_t i = 0; i < other.tableSize_; ++i) copyPage(other.table_[i].load(), i);
    if (mine > rows_) {
      addFree(rows_, mine);
      rows_ = mine;
    }
    prepared_ = false;  // neither copied pages nor pages without a counterpart are; `reserve` prepares them, as a snapshot does
                        // not need it
    return *this;
  }
  PagePool(PagePool&& other) noexcept { *this = std::move(other); }
  PagePool& operator=(PagePool&& other) noexcept {
    std::swap(table_, other.table_);
    std::swap(tableSize_, other.tableSize_);
    std::swap(rows_, other.rows_);
    std::swap(free_, other.free_);
    std::swap(wide_, other.wide_);
    std::swap(prepared_, other.prepared_);
    taken_.store(other.taken_.exchange(taken_.load()));
    return *this;
  }
  ~PagePool() {
    for (std::size_t i = 0; i < tableSize_; ++i) delete table_[i].load();
  }

  [[nodiscard]] Page& page(std::int32_t row) { return *table_[static_cast<std::size_t>(row) / kPageRows].load(kOrder); }
  [[nodiscard]] const Page& page(std::int32_t row) const {
    return *table_[static_cast<std::size_t>(row) / kPageRows].load(kOrder);
  }
  static std::size_t slot(std::int32_t row) { return static_cast<std::size_t>(row) % kPageRows; }

  /// Takes a row, of undefined content. Any thread. Precondition: fewer rows are in use than the `most` of `reserve`.
  std::int32_t take() {
    const std::size_t next = taken_.fetch_add(1, std::memory_order_relaxed);
    if (next < free_.size()) return free_[free_.size() - 1 - next];
    const std::size_t row = rows_ + (next - free_.size());
    makePage(row / kPageRows);
    return static_cast<std::int32_t>(row);
  }

  /// Returns a row. Not while others take.
  void giveBack(std::int32_t row) {
    settle();
    free_.push_back(row);
  }

  /// Returns all rows.
  void clear() {
    settle();
    free_.resize(rows_);
    for (std::size_t i = 0; i < rows_; ++i) free_[i] = static_cast<std::int32_t>(rows_ - 1 - i);
  }

  /// Makes sure that `free` rows can be taken without allocating a page, and that up to `most` can be in use at once. `wide`:
  /// whether pages are prepared for wide islands. Not while others take.
  void reserve(std::size_t free, std::size_t most, bool wide) {
    settle();
    if (!prepared_ || (wide && !wide_)) {
      wide_ = wide_ || wide;
      prepared_ = true;
      forEachPage([&](Page& page) { page.prepare(wide_); });
    }
    const std::size_t pages = std::max(most, rowsInUse() + free) / kPageRows + 2;
    if (pages > tableSize_) growTable(pages + pages / 4);
    while (free_.size() < free) {
      makePage(rows_ / kPageRows);
      addFree(rows_, rows_ + kPageRows);
      rows_ += kPageRows;
    }
  }

  template <class Visit>
  void forEachPage(const Visit& visit) {
    for (std::size_t i = 0; i < tableSize_; ++i) {
      if (Page* page = table_[i].load()) visit(*page);
    }
  }

  template <class Visit>
  void forEachPage(const Visit& visit) const {
    for (std::size_t i = 0; i < tableSize_; ++i) {
      if (const Page* page = table_[i].load()) visit(*page);
    }
  }

  [[nodiscard]] bool isWide() const { return wide_; }
  [[nodiscard]] std::size_t rowsInUse() const { return rows_ + taken_.load(std::memory_order_relaxed) - free_.size(); }
  [[nodiscard]] std::size_t pageCount() const {
    return static_cast<std::size_t>(
        std::count_if(table_.get(), table_.get() + tableSize_, [](const auto& p) { return p.load(); }));
  }

 private:
  static constexpr std::memory_order kOrder = std::memory_order_acquire;  // as cheap as none on x86

  // Removes from the list of free rows those that have been taken since the last call.
  void settle() {
    const std::size_t taken = taken_.exchange(0);
    if (taken <= free_.size()) {
      free_.resize(free_.size() - taken);
      return;
    }
    const std::size_t first = rows_ + (taken - free_.size());
    rows_ = (first + kPageRows - 1) / kPageRows * kPageRows;
    free_.clear();
    addFree(first, rows_);
  }

  // Inserts new rows below those that are already free: rows are taken from the back, the lowest first.
  void addFree(std::size_t first, std::size_t last) {
    std::vector<std::int32_t> rows;
    for (std::size_t row = last; row > first; --row) rows.push_back(static_cast<std::int32_t>(row - 1));
    free_.insert(free_.begin(), rows.begin(), rows.end());
    free_.reserve(rows_ + kPageRows);
  }

  void makePage(std::size_t at) {
    if (table_[at].load(kOrder) != nullptr) return;
    auto made = std::make_unique<Page>();
    made->prepare(wide_);
    Page* expected = nullptr;
    if (table_[at].compare_exchange_strong(expected, made.get()))
      static_cast<void>(made.release());  // otherwise another thread was first
  }

  void copyPage(const Page* from, std::size_t at) {
    Page* mine = table_[at].load();
    if (from == nullptr) return;
    if (mine != nullptr) {
      *mine = *from;
    } else {
      table_[at].store(std::make_unique<Page>(*from).release());
    }
  }

  void growTable(std::size_t size) {
    if (size <= tableSize_) return;
    auto larger = std::make_unique<std::atomic<Page*>[]>(size);
    for (std::size_t i = 0; i < size; ++i) larger[i].store(i < tableSize_ ? table_[i].load() : nullptr);
    table_ = std::move(larger);
    tableSize_ = size;
  }

  // Rows in use are rows_ + taken_ - free_.size(); settle() folds taken_ in.
  std::unique_ptr<std::atomic<Page*>[]> table_;
  std::size_t tableSize_ = 0;
  std::size_t rows_ = 0;               // of the pages that are settled
  std::vector<std::int32_t> free_;     // descending if none has been returned; taken from the back
  std::atomic<std::size_t> taken_{0};  // number of rows taken since, from the list and beyond it
  bool wide_ = false;
  bool prepared_ = true;  // whether all pages are
};

}  // namespace springtower
