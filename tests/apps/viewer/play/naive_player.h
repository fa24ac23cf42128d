#pragma once

#include "apps/viewer/view/state.h"

#include <cstdint>
#include <string>
#include <vector>

namespace springtower {

// A player who has never seen the program: the camera as it opens, one drag on a block that the hints call loose, one lift, one
// release over the top of the tower. It has a mouse and looks at the picture between its three gestures; it uses what the
// window's own callbacks call, and nothing else of the program.

/// What became of one game.
struct NaiveGame {
  std::uint64_t seed = 0;
  bool hinted = false;            ///< there was a loose block that is seen
  std::size_t block = 0;          ///< which it took
  int row = -1;                   ///< and where it lay, from 0
  std::string fault;              ///< why the game failed; empty if it did not
  double off_mm = 0.0;            ///< of the block's centre from the nearest place of the new row
  double off_deg = 0.0;           ///< of its direction
  double moved_mm = 0.0;          ///< the most that the centre of any other block has moved
  double force_n = 0.0;           ///< the largest force of the hand
  std::vector<double> frames_ms;  ///< processor time of each frame from the press to the rest
};

/// Plays one game on the tower of 18 rows with heights that vary by kUsualSigma_m. All of it follows from the seed.
NaiveGame playNaively(std::uint64_t seed);

}  // namespace springtower
