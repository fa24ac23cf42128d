#pragma once

#include "core/scene/scene.h"

namespace springtower {

/// The settings of a scene with the method `auto` replaced by the one that is expected to meet the tolerance fastest, from loads,
/// layers, falls and the tolerance: implicit steps, whose cost depends on neither load nor tolerance; but rigid blocks
/// (`rigid-pgs`) where one block or two fall askew so far or collide so fast that their impacts would cost more than the
/// simulation at rest. Substeps given by the user are kept.
Settings chooseMethod(const Scene& scene);

}  // namespace springtower
