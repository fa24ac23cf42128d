#pragma once

#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <mutex>

namespace springtower {

/// How far the search for the equilibria of a scene has come.
struct PrepareProgress {
  std::size_t blocks = 0;        ///< of all islands
  std::size_t blocksDone = 0;    ///< of islands whose search has ended
  std::uint64_t iterations = 0;  ///< of Newton's method, over all islands
  double elapsed_s = 0.0;        ///< s, wall time
};

/// Watches the searches of all islands, which run side by side: reports progress, and stops them when their time is spent or the
/// caller ends them.
class SearchMonitor {
 public:
  using GoesOn = std::function<bool(const PrepareProgress&)>;

  /// `goesOn` may be empty; see PrepareOptions.
  SearchMonitor(std::size_t blocks, double budget_s, const GoesOn& goesOn);

  /// Whether searches are to end where they are.
  [[nodiscard]] bool isStopped() const { return stopped_.load(std::memory_order_relaxed); }
  [[nodiscard]] bool isOutOfTime() const { return outOfTime_.load(std::memory_order_relaxed); }
  [[nodiscard]] double elapsed_s() const;

  /// After each iteration of an island, and with all of its blocks when its search has ended. Any thread.
  void iterationDone();
  void islandDone(std::size_t blocks);

 private:
  void look();

  std::size_t blocks_;
  double budget_s_;
  const GoesOn& goesOn_;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
  std::atomic<std::size_t> blocksDone_{0};
  std::atomic<std::uint64_t> iterations_{0};
  std::atomic<bool> stopped_{false};
  std::atomic<bool> outOfTime_{false};
  std::mutex calling_;
  double nextCall_s_ = 0.0;     // guarded by calling_
  bool endedByCaller_ = false;  // guarded by calling_; the caller has ended the search and is not called again
};

/// Whether a search that this watches, if there is one, is to end where it is. `monitor` may be null.
inline bool isStopped(const SearchMonitor* monitor) {
  return monitor != nullptr && monitor->isStopped();
}

}  // namespace springtower
