#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <oneapi/tbb/cache_aligned_allocator.h>
#include <vector>

namespace springtower {

using Vec3 = Eigen::Vector3d;

/// A vector whose storage starts on a cache line, so that the eight corners of a block (eight doubles, 64 bytes) share one line
/// per component.
template <class T>
using AlignedVector = std::vector<T, tbb::cache_aligned_allocator<T>>;

}  // namespace springtower
