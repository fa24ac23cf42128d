#pragma once

#include "core/scene/scene.h"
#include "core/scene/toml_table.h"

#include <string_view>
#include <vector>

namespace springtower {

/// The keys of a [[moves]] table.
extern const std::vector<std::string_view> kMoveKeys;

/// One move of a scripted sequence. Throws InputError naming the place in the file, also for a key that its kind of move has no
/// use for. Whether the sequence can be made is for checkMoves.
Move readMove(const Table& table);

}  // namespace springtower
