#pragma once

#include "core/lanes.h"
#include "narrowphase/manifold.h"

namespace springtower {

/// Memory and force of up to four points of a manifold, as the contact law works on them.
struct PointLanes {
  Lanes stretch[3];
  Lanes relaxed, offset, scale, live, sliding;
  Lanes force[3];
  Lanes normalForce;
};

/// Reads the memory of four points from the first one named on, and writes it back.
SPRINGTOWER_INLINE void loadPoints(const PointMemory& m, std::size_t first, PointLanes& p) {
  load(m.stretchX.data() + first, p.stretch[0]);
  load(m.stretchY.data() + first, p.stretch[1]);
  load(m.stretchZ.data() + first, p.stretch[2]);
  load(m.relaxed.data() + first, p.relaxed);
  load(m.offset.data() + first, p.offset);
  load(m.scale.data() + first, p.scale);
  load(m.live.data() + first, p.live);
  load(m.sliding.data() + first, p.sliding);
}

SPRINGTOWER_INLINE void storePoints(const PointLanes& p, std::size_t first, PointMemory& m) {
  store(p.stretch[0], m.stretchX.data() + first);
  store(p.stretch[1], m.stretchY.data() + first);
  store(p.stretch[2], m.stretchZ.data() + first);
  store(p.relaxed, m.relaxed.data() + first);
  store(p.offset, m.offset.data() + first);
  store(p.scale, m.scale.data() + first);
  store(p.live, m.live.data() + first);
  store(p.sliding, m.sliding.data() + first);
}

}  // namespace springtower
