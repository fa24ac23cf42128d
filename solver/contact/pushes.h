#pragma once

#include "solver/world/island_step.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace springtower {

/// Calls `visit(user, mean)` for every user force that acts on a block of the island in some part of the time from `from_s` to
/// `until_s` (s), with its mean over that time. What acted before the present frame began is that of the frame before, as it was
/// then: forces may be changed between frames. For such times a force may be visited twice, with two parts of its mean.
template <class Visit>
void forEachPush(const IslandStep& step, double from_s, double until_s, const Visit& visit) {
  if (!(from_s < until_s)) return;
  const std::vector<std::int32_t>& islandOf = step.engine.memo.islands.islandOf;
  const std::int32_t own = islandOf[static_cast<std::size_t>(step.blocks.front())];
  const auto visitAll = [&](const std::vector<UserForce>& forces, double begin_s, double end_s) {
    if (!(begin_s < end_s)) return;
    const double share = (end_s - begin_s) / (until_s - from_s);
    for (const UserForce& user : forces) {
      if (!user.actsWithin(begin_s, end_s) || islandOf[static_cast<std::size_t>(user.block)] != own) continue;
      const Load mean = user.meanOver(begin_s, end_s);
      visit(user, Load{share * mean.force, share * mean.torque});
    }
  };
  const double frame_s = step.simulation.time_s;
  visitAll(step.engine.memo.forcesBefore, from_s, std::min(until_s, frame_s));
  visitAll(step.simulation.scene.forces, std::max(from_s, frame_s), until_s);
}

/// Whether user forces on the island jump from the step of `before_s` that ends where this one of `step_s` begins: by more than
/// tuning::kPushJump of what acts. Where there was no such step (0), any force is a jump.
bool pushesJump(const IslandStep& step, double before_s, double step_s);

}  // namespace springtower
