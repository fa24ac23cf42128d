#pragma once

#include "core/scene/scene.h"

#include <span>
#include <string_view>

namespace springtower {

/// A tower whose instructions are counted (bench/gate_scenes.cpp) and whose bits are pinned (tests/pinned); both use the same
/// frames.
struct GateTower {
  std::string_view name;
  int rows;
  double heightsSigma_m;
  double tilt_deg;
  double pull_m_s;  ///< speed at which the middle block of the middle row is pulled out, 0 for none
};

/// All of them.
std::span<const GateTower> gateTowers();

/// Its scene for a method, without sleep.
Scene sceneOf(const GateTower& gate, Method method);

}  // namespace springtower
