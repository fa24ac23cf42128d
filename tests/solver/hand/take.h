#pragma once

#include "core/scene/scene.h"

namespace springtower {

/// A move that draws a block out of a tower, with the default hand of scene files.
inline Move take(int row, int position, const Vec3& towards, double speed_m_s = 0.04) {
  Move move;
  move.row = row;
  move.position = position;
  move.towards = towards;
  move.speed_m_s = speed_m_s;
  return move;
}

}  // namespace springtower
