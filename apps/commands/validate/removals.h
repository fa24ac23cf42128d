#pragma once

#include "core/scene/scene.h"

#include <cstddef>
#include <limits>
#include <string>
#include <vector>

namespace springtower {

/// A tower from which blocks are taken one by one, as a line of removal.jsonl has it.
struct Removals {
  struct Place {
    int row;       ///< from 0
    int position;  ///< 1 to 3
  };
  std::string id;
  Scene scene;                    ///< before the first removal
  std::vector<Place> removed;     ///< in their order; each is of a block that is there
  std::vector<bool> standsAfter;  ///< by statics: before the first removal, and after each
};

/// More lines than a file has.
inline constexpr std::size_t kAllRemovals = std::numeric_limits<std::size_t>::max();

/// Reads the first lines of `folder`/removal.jsonl, at most `most`. Throws InputError that names the option --oracle, the file
/// and the line where there is none, where it is not what it should be, and where a block is taken that is not there.
std::vector<Removals> readRemovals(const std::string& folder, std::size_t most);

}  // namespace springtower
