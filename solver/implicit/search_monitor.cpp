#include "solver/implicit/search_monitor.h"

namespace springtower {

namespace {

constexpr double kSecondsBetweenCalls = 0.1;  // often enough for a person who watches, too seldom to cost anything

}  // namespace

SearchMonitor::SearchMonitor(std::size_t blocks, double budget_s, const GoesOn& goesOn)
    : blocks_(blocks), budget_s_(budget_s), goesOn_(goesOn) {
  look();
}

double SearchMonitor::elapsed_s() const {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
}

void SearchMonitor::iterationDone() {
  iterations_.fetch_add(1, std::memory_order_relaxed);
  look();
}

void SearchMonitor::islandDone(std::size_t blocks) {
  blocksDone_.fetch_add(blocks, std::memory_order_relaxed);
  look();
}

void SearchMonitor::look() {
  const double now_s = elapsed_s();
  if (now_s >= budget_s_) {
    outOfTime_.store(true, std::memory_order_relaxed);
    stopped_.store(true, std::memory_order_relaxed);
  }
  if (!goesOn_) return;
  const std::unique_lock<std::mutex> lock(calling_, std::try_to_lock);
  if (!lock.owns_lock() || endedByCaller_ || now_s < nextCall_s_) return;
  nextCall_s_ = now_s + kSecondsBetweenCalls;
  const PrepareProgress progress{blocks_, blocksDone_.load(std::memory_order_relaxed),
                                 iterations_.load(std::memory_order_relaxed), now_s};
  if (goesOn_(progress)) return;
  endedByCaller_ = true;
  stopped_.store(true, std::memory_order_relaxed);
}

}  // namespace springtower
