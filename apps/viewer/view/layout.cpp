#include "apps/viewer/view/layout.h"

#include <algorithm>
#include <array>

namespace springtower {
namespace {

constexpr float kCardDown = 0.1F;  // of the room: what has fallen lies below

bool isInside(const Rect& rect, const Extent& window, float margin) {
  return rect.x >= margin && rect.y >= margin && rect.x + rect.width <= window.width - margin &&
         rect.y + rect.height <= window.height - margin;
}

Rect grownBy(const Rect& rect, float margin) {
  return {rect.x - margin, rect.y - margin, rect.width + 2.0F * margin, rect.height + 2.0F * margin};
}

// At the lower or upper right of a place, or at its left, wherever nothing else lies; as near as the window's sides let it be.
Rect besidePlace(const Extent& window, const Layout& others, const Extent& size, const Extent& at, float margin) {
  constexpr float kAway = 2.0F;  // margins from the place
  const float away = kAway * margin;
  const std::array<float, 2> columns = {at.width + away, at.width - away - size.width};
  const std::array<float, 2> lines = {at.height + away, at.height - away - size.height};
  for (const float x : columns) {
    for (const float y : lines) {
      const float upperX = std::max(margin, window.width - margin - size.width);
      const float upperY = std::max(margin, window.height - margin - size.height);
      const Rect rect = {std::clamp(x, margin, upperX), std::clamp(y, margin, upperY), size.width, size.height};
      bool free = isInside(rect, window, margin);
      for (const Rect* other : {&others.notices, &others.bar, &others.legend, &others.lab, &others.card})
        free = free && !overlap(rect, *other);
      if (free) return rect;
    }
  }
  return {};
}

}  // namespace

bool isEmpty(const Rect& rect) {
  return rect.width <= 0.0F || rect.height <= 0.0F;
}

bool overlap(const Rect& a, const Rect& b) {
  if (isEmpty(a) || isEmpty(b)) return false;
  return a.x < b.x + b.width && b.x < a.x + a.width && a.y < b.y + b.height && b.y < a.y + a.height;
}

float widthBeside(const Extent& window, float labWidth, float margin) {
  return std::max(0.0F, window.width - 2.0F * margin - (labWidth > 0.0F ? labWidth + margin : 0.0F));
}

Layout layoutOf(const Extent& window, const Wanted& wanted, const Extent& at, float margin) {
  Layout layout;
  const float right = window.width - margin;
  const float bottom = window.height - margin;
  layout.bar = {margin, bottom - wanted.bar.height, wanted.bar.width, wanted.bar.height};
  layout.legend = {right - wanted.legend.width, bottom - wanted.legend.height, wanted.legend.width, wanted.legend.height};
  if (overlap(grownBy(layout.bar, margin), layout.legend)) layout.legend.y = layout.bar.y - margin - wanted.legend.height;

  float lowest = bottom;  // where what lies below begins
  layout.lab = {margin, margin, std::min(wanted.lab.width, window.width - 2.0F * margin), wanted.lab.height};
  for (const Rect* below : {&layout.bar, &layout.legend}) {
    const bool under = below->x < layout.lab.x + layout.lab.width + margin;
    if (!isEmpty(*below) && under) lowest = std::min(lowest, below->y - margin);
  }
  layout.lab.height = std::clamp(lowest - margin, 0.0F, wanted.lab.height);

  const float left = right - widthBeside(window, layout.lab.width, margin);
  const auto middle = [&](float width) { return left + 0.5F * std::max(0.0F, right - left - width); };
  layout.notices = {middle(wanted.notices.width), margin, wanted.notices.width, wanted.notices.height};
  const float top = wanted.notices.height > 0.0F ? 2.0F * margin + wanted.notices.height : margin;
  float floor = bottom;
  for (const Rect* below : {&layout.bar, &layout.legend}) {
    if (!isEmpty(*below)) floor = std::min(floor, below->y - margin);
  }
  layout.card = {middle(wanted.card.width), std::max(top, top + kCardDown * (floor - top - wanted.card.height)),
                 wanted.card.width, wanted.card.height};
  if (!isEmpty({0.0F, 0.0F, wanted.words.width, wanted.words.height}))
    layout.words = besidePlace(window, layout, wanted.words, at, margin);
  return layout;
}

}  // namespace springtower
