#pragma once

#include "apps/viewer/session/session.h"

#include <chrono>
#include <cstdint>
#include <future>
#include <optional>

namespace springtower {

// Statics of the tower as it stands, found beside the drawing, which does not wait for it.

/// What statics says of the tower without one block (kFloor: of all of it), as far as it is known.
struct StaticsAnswer {
  BlockId without = kFloor;
  std::uint64_t frame = 0;  ///< when it was started
  bool known = false;
  bool asleep = false;  ///< all blocks slept then: nothing changes until one wakes
  std::chrono::steady_clock::time_point started{};
  std::chrono::steady_clock::time_point next{};  ///< not before that it is started again: statics takes a quarter of a processor
  std::optional<StabilityMargin> margin;         ///< empty where there is no equilibrium at all; see marginOf
  std::future<std::optional<StabilityMargin>> coming;
};

/// Follows the statics without a block: starts them again when the tower has gone on for `every` frames, or another block is
/// meant. `waits`: the answer is there on return.
void followStatics(StaticsAnswer& answer, const Session& session, BlockId without, std::uint64_t every, bool waits);

}  // namespace springtower
