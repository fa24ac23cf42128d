#pragma once

#include <cstddef>
#include <vector>

namespace springtower {

/// Reserves room for `size` values; where there is too little, for an eighth and eight more. std::vector by itself would double
/// its room, which wastes memory in large vectors.
template <class T>
void reserveClosely(std::size_t size, std::vector<T>& values) {
  if (size > values.capacity()) values.reserve(size + size / 8 + 8);
}

}  // namespace springtower
