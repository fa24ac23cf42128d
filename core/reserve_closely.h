#pragma once

#include <cstddef>
#include <vector>

namespace springtower {

/// Makes room for `size` values, an eighth and some more where there is too little. Vectors by themselves double then, which is
/// too much of what is large.
template <class T>
void reserveClosely(std::size_t size, std::vector<T>& values) {
  if (size > values.capacity()) values.reserve(size + size / 8 + 8);
}

}  // namespace springtower
