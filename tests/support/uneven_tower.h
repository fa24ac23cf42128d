#pragma once

#include "core/scene/scene.h"
#include "scenarios/towers.h"

namespace springtower {

/// A tower whose heights vary as those of real blocks do.
inline Scene unevenTower(int rows) {
  TowerOptions options;
  options.heightsSigma_m = kUnevenHeightsSigma_m;
  options.seed = 3;
  return towerScene(rows, options);
}

}  // namespace springtower
