#pragma once

#include <algorithm>
#include <cstddef>
#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/parallel_reduce.h>
#include <oneapi/tbb/partitioner.h>
#include <oneapi/tbb/task_arena.h>

#ifdef SPRINGTOWER_PLAIN_THREADS  // of CMake: std::thread instead of oneTBB, whose library ThreadSanitizer cannot see into
#include "core/plain_threads.h"
#endif

namespace springtower {

/// Threads on which parallel kernels run here, at most.
inline std::size_t threadsNow() {
  const std::size_t allowed = tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism);
#ifdef SPRINGTOWER_PLAIN_THREADS
  return allowed;
#else
  return std::min(allowed, static_cast<std::size_t>(std::max(1, tbb::this_task_arena::max_concurrency())));
#endif
}

/// Runs kernel(first, last) over [0, count): in one call, or where `parallel` in ranges of at least about `grain` on many
/// threads. A call writes only what belongs to its range, so that the result is the same either way.
template <class Kernel>
void forRanges(std::size_t count, std::size_t grain, bool parallel, const Kernel& kernel) {
  if (!parallel) {
    kernel(std::size_t{0}, count);
    return;
  }
#ifdef SPRINGTOWER_PLAIN_THREADS
  plain::forRanges(count, grain, threadsNow(), kernel);
#else
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, grain),
                    [&](const tbb::blocked_range<std::size_t>& range) { kernel(range.begin(), range.end()); });
#endif
}

/// The same, in as many ranges as there are threads at most, each on the same thread in every call where that is free: what one
/// call leaves in a core's cache the next one finds there.
template <class Kernel>
void forEqualRanges(std::size_t count, std::size_t grain, bool parallel, const Kernel& kernel) {
#ifdef SPRINGTOWER_PLAIN_THREADS
  forRanges(count, grain, parallel, kernel);
#else
  if (!parallel || threadsNow() == 1) {
    kernel(std::size_t{0}, count);
    return;
  }
  tbb::parallel_for(
      tbb::blocked_range<std::size_t>(0, count, grain),
      [&](const tbb::blocked_range<std::size_t>& range) { kernel(range.begin(), range.end()); }, tbb::static_partitioner());
#endif
}

/// Runs kernel(i) for every i of [0, count) on many threads. A call writes only what belongs to its i.
template <class Kernel>
void forEach(std::size_t count, const Kernel& kernel) {
#ifdef SPRINGTOWER_PLAIN_THREADS
  plain::forParts(count, threadsNow(), kernel);
#else
  tbb::parallel_for(std::size_t{0}, count, kernel);
#endif
}

/// Merges the values of kernel(first, last) over [0, count), ranges as above. Precondition: `merge` gives the same in any order
/// and grouping, as a maximum, a logical operation or a sum of integers does; `nothing` is its neutral element.
template <class T, class Kernel, class Merge>
T mergeRanges(std::size_t count, std::size_t grain, bool parallel, T nothing, const Kernel& kernel, const Merge& merge) {
  if (!parallel) return merge(nothing, kernel(std::size_t{0}, count));
#ifdef SPRINGTOWER_PLAIN_THREADS
  return plain::mergeRanges(count, grain, threadsNow(), nothing, kernel, merge);
#else
  return tbb::parallel_reduce(
      tbb::blocked_range<std::size_t>(0, count, grain), nothing,
      [&](const tbb::blocked_range<std::size_t>& range, const T& sofar) {
        return merge(sofar, kernel(range.begin(), range.end()));
      },
      merge);
#endif
}

/// Sum of the values of kernel(first, last) over [0, count): in one call, or where `parallel` over ranges that are halved down to
/// `grain` and added pairwise, so that the bits are the same for any number of threads.
template <class Kernel>
double sumRanges(std::size_t count, std::size_t grain, bool parallel, const Kernel& kernel) {
  if (!parallel) return kernel(std::size_t{0}, count);
#ifdef SPRINGTOWER_PLAIN_THREADS
  return plain::sumRanges(count, grain, threadsNow(), kernel);
#else
  return tbb::parallel_deterministic_reduce(
      tbb::blocked_range<std::size_t>(0, count, grain), 0.0,
      [&](const tbb::blocked_range<std::size_t>& range, double sofar) { return sofar + kernel(range.begin(), range.end()); },
      [](double a, double b) { return a + b; });
#endif
}

}  // namespace springtower
