#pragma once

#include "core/ids.h"
#include "core/vector.h"

#include <nlohmann/json_fwd.hpp>
#include <string>

namespace springtower {

inline constexpr double kMillimetres = 1e3;  ///< in a metre: reports give small lengths in mm

/// [x, y, z].
nlohmann::ordered_json vectorJson(const Vec3& vector);

/// A JSON value as text, of one line where `indent` is -1. Names of files may hold any bytes and JSON none that are not UTF-8:
/// those become U+FFFD.
std::string jsonText(const nlohmann::ordered_json& json, int indent = -1);

/// The block's number, or "floor".
nlohmann::ordered_json blockJson(BlockId block);

}  // namespace springtower
