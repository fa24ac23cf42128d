#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#ifdef SPRINGTOWER_PLAIN_THREADS
#include "core/plain_allocator.h"
#else
#include <oneapi/tbb/cache_aligned_allocator.h>
#endif
#include <vector>

namespace springtower {

using Vec3 = Eigen::Vector3d;

/// A vector whose storage starts on a cache line, so that the eight corners of a block (eight doubles, 64 bytes) share one line
/// per component.
#ifdef SPRINGTOWER_PLAIN_THREADS
template <class T>
using AlignedVector = std::vector<T, plain::AlignedAllocator<T>>;
#else
template <class T>
using AlignedVector = std::vector<T, tbb::cache_aligned_allocator<T>>;
#endif

}  // namespace springtower
