#pragma once

#include "core/scene/scene.h"

#include <cstddef>

namespace springtower {

/// Takes a block out of a scene. Those after it are numbered anew in pairs with friction of their own; what forces and moves
/// name is left as it is. Precondition: there is such a block.
void removeBlock(Scene& scene, std::size_t block);

}  // namespace springtower
