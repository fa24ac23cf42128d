#pragma once

#include "core/ids.h"
#include "core/vector.h"

#include <nlohmann/json_fwd.hpp>

namespace springtower {

inline constexpr double kMillimetres = 1e3;  ///< in a metre: reports give small lengths in mm

/// [x, y, z].
nlohmann::ordered_json vectorJson(const Vec3& vector);

/// The block's number, or "floor".
nlohmann::ordered_json blockJson(BlockId block);

}  // namespace springtower
