#pragma once

#include <algorithm>
#include <cstddef>
#include <exception>
#include <thread>
#include <vector>

/// What core/parallel.h does, on std::thread instead of oneTBB: for ThreadSanitizer, which takes what it cannot see in oneTBB's
/// library for races. Threads are new in every call, so that no lock or queue puts an order between them which the engine does
/// not rely on, and neighbouring parts always run on different ones. Calls may be nested.
namespace springtower::plain {

struct Range {
  std::size_t first;
  std::size_t last;
};

/// Runs kernel(i) for i in [0, parts): thread t takes t, t + threads and so on; the caller is thread 0. When all have ended, what
/// the first of the threads that failed has thrown is thrown again.
template <class Kernel>
void forParts(std::size_t parts, std::size_t threads, const Kernel& kernel) {
  const std::size_t used = std::max<std::size_t>(1, std::min(parts, threads));
  std::vector<std::exception_ptr> errors(used);
  const auto run = [&](std::size_t thread) {
    try {
      for (std::size_t i = thread; i < parts; i += used) kernel(i);
    } catch (...) {
      errors[thread] = std::current_exception();
    }
  };
  std::vector<std::thread> others;
  others.reserve(used - 1);
  for (std::size_t thread = 1; thread < used; ++thread) others.emplace_back(run, thread);
  run(0);
  for (std::thread& other : others) other.join();
  for (const std::exception_ptr& error : errors) {
    if (error != nullptr) std::rethrow_exception(error);
  }
}

/// Halves a range until no part is longer than `grain`, as oneTBB's blocked_range is split; parts are in order.
inline void halve(Range range, std::size_t grain, std::vector<Range>& parts) {
  if (range.first == range.last) return;
  if (range.last - range.first <= grain) {
    parts.push_back(range);
    return;
  }
  const std::size_t middle = range.first + (range.last - range.first) / 2;
  halve({range.first, middle}, grain, parts);
  halve({middle, range.last}, grain, parts);
}

/// A range, and the value of kernel(first, last) on it: in a struct, so that no two values share a byte, as the elements of
/// std::vector<bool> do.
template <class T>
struct RangeValue {
  Range range;
  T value;
};

template <class T, class Kernel>
std::vector<RangeValue<T>> valuesOfRanges(std::size_t count, std::size_t grain, std::size_t threads, const T& nothing,
                                          const Kernel& kernel) {
  std::vector<Range> ranges;
  halve({0, count}, grain, ranges);
  std::vector<RangeValue<T>> parts;
  parts.reserve(ranges.size());
  for (const Range& range : ranges) parts.push_back({range, nothing});
  forParts(parts.size(), threads, [&](std::size_t i) { parts[i].value = kernel(parts[i].range.first, parts[i].range.last); });
  return parts;
}

template <class Kernel>
void forRanges(std::size_t count, std::size_t grain, std::size_t threads, const Kernel& kernel) {
  std::vector<Range> ranges;
  halve({0, count}, grain, ranges);
  forParts(ranges.size(), threads, [&](std::size_t i) { kernel(ranges[i].first, ranges[i].last); });
}

template <class T, class Kernel, class Merge>
T mergeRanges(std::size_t count, std::size_t grain, std::size_t threads, T nothing, const Kernel& kernel, const Merge& merge) {
  T all = nothing;
  for (RangeValue<T>& part : valuesOfRanges(count, grain, threads, nothing, kernel)) all = merge(all, part.value);
  return all;
}

/// Sum over a range of the values of its parts, of which the first is at `next`: pairwise, by the same halves.
inline double pairwiseSum(Range range, const std::vector<RangeValue<double>>& parts, std::size_t& next) {
  if (parts[next].range.last == range.last) return 0.0 + parts[next++].value;  // as oneTBB begins each part with zero
  const std::size_t middle = range.first + (range.last - range.first) / 2;
  const double left = pairwiseSum({range.first, middle}, parts, next);
  return left + pairwiseSum({middle, range.last}, parts, next);
}

template <class Kernel>
double sumRanges(std::size_t count, std::size_t grain, std::size_t threads, const Kernel& kernel) {
  if (count == 0) return 0.0;
  const std::vector<RangeValue<double>> parts = valuesOfRanges(count, grain, threads, 0.0, kernel);
  std::size_t next = 0;
  return pairwiseSum({0, count}, parts, next);
}

}  // namespace springtower::plain
