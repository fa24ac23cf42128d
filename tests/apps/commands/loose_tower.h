#pragma once

#include "core/scene/scene.h"

#include <cstddef>

namespace springtower {

/// A small tower with one loose block, whose number is kLooseBlock, and how high it is.
inline constexpr const char* kLooseTower = "(111)-(1L1)-(111)-(111)";
inline constexpr std::size_t kLooseBlock = 4;
inline constexpr double kTop_m = 4 * kBlockHeight_m;

}  // namespace springtower
