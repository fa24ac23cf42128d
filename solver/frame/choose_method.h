#pragma once

#include "core/scene/scene.h"

namespace springtower {

/// The settings of a scene with the method `auto` replaced by what is foreseen to meet the tolerance fastest, from loads, layers,
/// falls and the tolerance alone: implicit steps, whose cost depends on neither load nor tolerance; but rigid blocks
/// (`rigid-pgs`) where one block, two, or very many fall askew so far or meet so fast that their hits would cost more than rest
/// does. Substeps that were asked for stay.
Settings chooseMethod(const Scene& scene);

}  // namespace springtower
