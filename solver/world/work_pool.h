#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <memory>
#include <utility>

namespace springtower {

/// Working data that islands take while they are stepped and give back: as many records as are in use at the same time, not one
/// for each island. What a record holds when it is taken is of whatever island had it last, so nothing may be read that has not
/// been written. On one thread it is always the same record.
template <class Record>
class WorkPool {
 public:
  /// A record in use; given back at the end of its life.
  class Taken {
   public:
    Taken(const Taken&) = delete;
    Taken& operator=(const Taken&) = delete;
    ~Taken() {
      if (isTaken_ != nullptr) isTaken_->store(false, std::memory_order_release);
    }
    [[nodiscard]] Record& record() const { return *record_; }

   private:
    friend class WorkPool;
    Taken(Record& record, std::atomic<bool>& isTaken) : record_(&record), isTaken_(&isTaken) {}
    explicit Taken(std::unique_ptr<Record> own) : own_(std::move(own)), record_(own_.get()) {}

    std::unique_ptr<Record> own_;
    Record* record_;
    std::atomic<bool>* isTaken_ = nullptr;
  };

  /// A record that nobody else uses. Any thread.
  [[nodiscard]] Taken take() {
    for (Slot& slot : slots_) {
      if (slot.isTaken.load(std::memory_order_relaxed) || slot.isTaken.exchange(true, std::memory_order_acquire)) continue;
      if (slot.record == nullptr) slot.record = std::make_unique<Record>();
      return Taken(*slot.record, slot.isTaken);
    }
    return Taken(std::make_unique<Record>());
  }

  /// Calls visit(record) for each that there is. Not while any is taken.
  template <class Visit>
  void forEach(const Visit& visit) {
    for (Slot& slot : slots_) {
      if (slot.record != nullptr) visit(*slot.record);
    }
  }
  template <class Visit>
  void forEach(const Visit& visit) const {
    for (const Slot& slot : slots_) {
      if (slot.record != nullptr) visit(std::as_const(*slot.record));
    }
  }

 private:
  struct Slot {
    std::atomic<bool> isTaken = false;
    std::unique_ptr<Record> record;
  };

  // One for each thread, and some where a thread that waits within one island runs another one.
  static constexpr std::size_t kSlots = 128;
  std::array<Slot, kSlots> slots_;
};

}  // namespace springtower
