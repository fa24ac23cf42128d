#include "tests/support/drawn_scenes.h"

#include "core/error.h"
#include "core/rotation_vector.h"
#include "scenarios/towers.h"
#include "tests/support/random.h"

#include <array>
#include <fmt/format.h>
#include <string>

namespace springtower {

Scene shiftedTower(std::uint64_t seed) {
  constexpr std::array kRows = {"111", "111", "110", "011", "101", "010", "100", "001"};
  Random random{SplitMix64(seed)};
  for (;;) {
    const int rows = 3 + random.below(8);
    std::string code;
    TowerOptions options;
    for (int row = 0; row < rows; ++row) {
      const std::string places = kRows[static_cast<std::size_t>(random.below(static_cast<std::int32_t>(kRows.size())))];
      code += fmt::format("{}({})", row == 0 ? "" : "-", places);
      for (int position = 1; position <= 3; ++position) {
        if (places[static_cast<std::size_t>(position - 1)] == '0') continue;
        options.offsets.push_back({row, position, 5e-5 * (random.below(81) - 40), 5e-5 * (random.below(81) - 40)});
      }
    }
    try {
      return bitCodeScene(code, options);
    } catch (const InputError&) {
      // Blocks beside one another overlap: the next draw.
    }
  }
}

Scene leaningUnevenTower(std::uint64_t seed) {
  Random random{SplitMix64(seed)};
  Scene scene = towerScene(6 + random.below(13), {.heightsSigma_m = kUnevenHeightsSigma_m, .seed = seed});
  scene.gravity.tilt_deg = random.chance(0.5) ? random.between(0.0, 3.0) : 0.0;
  scene.gravity.direction_deg = random.between(-180.0, 180.0);
  return scene;
}

Scene droppedBlocks(std::uint64_t seed) {
  Random random{SplitMix64(seed)};
  // From z to x: the order in which arguments are evaluated is unspecified, and scenes must not depend on the compiler.
  const auto anyVector = [&] {
    Vec3 vector;
    for (int a = 2; a >= 0; --a) vector[a] = random.between(-1.0, 1.0);
    return vector;
  };
  Scene scene;
  scene.name = fmt::format("dropped blocks {}", seed);
  const int blocks = 1 + random.below(6);
  for (int b = 0; b < blocks; ++b) {
    BlockSpec block;
    block.centre.z() = 0.06 + 0.1 * b + random.between(0.0, 0.01);
    for (int a = 1; a >= 0; --a) block.centre[a] = random.between(-0.02, 0.02);
    block.orientation = rotation(3.0 * anyVector());
    block.velocity = 0.3 * anyVector();
    block.spin = 5.0 * anyVector();
    block.mass *= random.between(0.3, 3.0);
    scene.blocks.push_back(block);
  }
  return scene;
}

Scene topplingTower(std::uint64_t seed) {
  Random random{SplitMix64(seed)};
  const int rows = 3 + random.below(8);
  Scene scene = towerScene(rows, {.heightsSigma_m = random.chance(0.5) ? 0.0 : kUnevenHeightsSigma_m, .seed = seed});
  scene.gravity.tilt_deg = collapseTilt_deg(rows) + random.between(1.0, 6.0);
  scene.gravity.direction_deg = random.between(-180.0, 180.0);
  return scene;
}

}  // namespace springtower
