#pragma once

#include "apps/viewer/view/state.h"

#include <optional>
#include <string>
#include <vector>

namespace springtower {

// What a user reads over the picture.

/// A line, and how much of it is to be seen, 0..1.
struct Notice {
  std::string text;
  double strength = 1.0;
};

/// What is shown above: the game, slow motion, a replay that differs, and a message that fades.
std::vector<Notice> notices(const Viewer& viewer);

inline constexpr std::size_t kMostWords = 3;

/// At most kMostWords short lines for one place of the picture.
struct Words {
  std::vector<std::string> lines;
  Eigen::Vector2d at;              ///< pixels of the picture
  std::optional<Colour> emphasis;  ///< of the first line
};

/// What can be done now, beside the mouse; what the hand's block needs; or how a block is held. `mouseInside`: the mouse is over
/// the picture. Empty where there is nothing to be said.
std::optional<Words> wordsAt(const Viewer& viewer, bool mouseInside);

/// What happened, after a fall: what fell and what did it, a line each; empty while nothing has fallen.
std::vector<std::string> cardLines(const Viewer& viewer);

/// The rows of the legend: of the colours, of the arrows, and of the ring.
std::vector<LegendRow> legendRows(const Viewer& viewer);

}  // namespace springtower
