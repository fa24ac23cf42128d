#pragma once

#include <cstddef>

namespace springtower {

inline constexpr std::size_t kNodeSize = 12;                       // degrees of freedom of a node
inline constexpr std::size_t kNodeMatrix = kNodeSize * kNodeSize;  // floats of a block of the matrix, row by row

}  // namespace springtower
