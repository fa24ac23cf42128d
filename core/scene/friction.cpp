#include "core/scene/friction.h"

#include "core/scene/scene.h"

#include <algorithm>
#include <cmath>

namespace springtower {

namespace {

// Equal coefficients keep their bits.
double meanOf(double a, double b) {
  return a == b ? a : std::sqrt(a * b);
}

}  // namespace

FrictionTable::FrictionTable(const Scene& scene) : scene_{scene.staticFriction, scene.kineticFriction} {
  const bool varies = scene.floorFriction || !scene.frictionPairs.empty() ||
                      std::any_of(scene.blocks.begin(), scene.blocks.end(), [](const BlockSpec& b) { return b.friction; });
  if (!varies) return;
  surfaces_.reserve(scene.blocks.size() + 1);
  surfaces_.push_back(scene.floorFriction.value_or(scene_));
  for (const BlockSpec& block : scene.blocks) surfaces_.push_back(block.friction.value_or(scene_));
  for (const FrictionPair& pair : scene.frictionPairs)
    pairs_.emplace_back(std::pair<std::int32_t, std::int32_t>(std::minmax(pair.a, pair.b)), pair.friction);
  std::sort(pairs_.begin(), pairs_.end(), [](const auto& one, const auto& other) { return one.first < other.first; });
}

Friction FrictionTable::ofSurfaces(std::int32_t a, std::int32_t b) const {
  if (!pairs_.empty()) {
    const std::pair<std::int32_t, std::int32_t> key = std::minmax(a, b);
    const auto found = std::lower_bound(pairs_.begin(), pairs_.end(), key,
                                        [](const auto& one, const auto& sought) { return one.first < sought; });
    if (found != pairs_.end() && found->first == key) return found->second;
  }
  const Friction& first = surfaceOf(a);
  const Friction& second = surfaceOf(b);
  return {meanOf(first.staticFriction, second.staticFriction), meanOf(first.kineticFriction, second.kineticFriction)};
}

}  // namespace springtower
