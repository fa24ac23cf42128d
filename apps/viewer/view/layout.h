#pragma once

namespace springtower {

// Where words, buttons and panels lie over the picture. All are functions of sizes, in pixels of the window.

/// A width and a height; zero where there is nothing.
struct Extent {
  float width = 0.0F;
  float height = 0.0F;
};

/// A rectangle, from its upper left corner.
struct Rect {
  float x = 0.0F;
  float y = 0.0F;
  float width = 0.0F;
  float height = 0.0F;
};

/// Whether there is nothing in it.
bool isEmpty(const Rect& rect);

/// Whether two rectangles share some of their inside.
bool overlap(const Rect& a, const Rect& b);

/// The sizes that the parts would have.
struct Wanted {
  Extent notices;  ///< what the game and messages say
  Extent bar;      ///< the few buttons
  Extent legend;   ///< what colours mean
  Extent lab;      ///< the panel; it may be made less high, and scrolls then
  Extent card;     ///< what happened, after a fall
  Extent words;    ///< at the mouse or at a block
};

/// Where the parts lie: inside the window, none over another. What finds no room is empty.
struct Layout {
  Rect notices;
  Rect bar;
  Rect legend;
  Rect lab;
  Rect card;
  Rect words;
};

/// Lays the parts out: the bar below on the left, the legend below on the right or over the bar, the panel on the left above, the
/// notices in the middle above of what is left of the width, the card below them, the words beside the place that they are
/// about (`at`), on whichever side there is room. `margin`: between parts, and to the window's sides.
Layout layoutOf(const Extent& window, const Wanted& wanted, const Extent& at, float margin);

/// The width that is left for notices and card beside a panel of this width.
float widthBeside(const Extent& window, float labWidth, float margin);

}  // namespace springtower
