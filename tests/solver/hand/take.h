#pragma once

#include "core/scene/scene.h"

namespace springtower {

/// A move that draws a block out of a tower, by a hand as scene files have it unless told otherwise.
inline Move take(int row, int position, const Vec3& towards, double speed_m_s = 0.04) {
  Move move;
  move.row = row;
  move.position = position;
  move.towards = towards;
  move.speed_m_s = speed_m_s;
  return move;
}

}  // namespace springtower
