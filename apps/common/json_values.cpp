#include "apps/common/json_values.h"

#include <nlohmann/json.hpp>

namespace springtower {

nlohmann::ordered_json vectorJson(const Vec3& vector) {
  return nlohmann::ordered_json::array({vector.x(), vector.y(), vector.z()});
}

std::string jsonText(const nlohmann::ordered_json& json, int indent) {
  return json.dump(indent, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

nlohmann::ordered_json blockJson(BlockId block) {
  return block == kFloor ? nlohmann::ordered_json("floor") : nlohmann::ordered_json(index(block));
}

}  // namespace springtower
