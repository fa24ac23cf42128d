#include "core/scene/remove_block.h"

#include <vector>

namespace springtower {

void removeBlock(Scene& scene, std::size_t block) {
  scene.blocks.erase(scene.blocks.begin() + static_cast<std::ptrdiff_t>(block));
  const auto gone = static_cast<int>(block);
  std::erase_if(scene.frictionPairs, [&](const FrictionPair& pair) { return pair.a == gone || pair.b == gone; });
  for (FrictionPair& pair : scene.frictionPairs) {
    if (pair.a > gone) --pair.a;
    if (pair.b > gone) --pair.b;
  }
}

}  // namespace springtower
