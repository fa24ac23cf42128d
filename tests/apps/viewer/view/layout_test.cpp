#include "apps/viewer/view/layout.h"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <vector>

namespace springtower {
namespace {

struct Named {
  const char* name;
  Rect rect;
};

std::vector<Named> partsOf(const Layout& layout) {
  return {{"notices", layout.notices}, {"bar", layout.bar},   {"legend", layout.legend},
          {"lab", layout.lab},         {"card", layout.card}, {"words", layout.words}};
}

void expectApartAndInside(const Layout& layout, const Extent& window) {
  const std::vector<Named> parts = partsOf(layout);
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const Rect& rect = parts[i].rect;
    if (isEmpty(rect)) continue;
    EXPECT_GE(rect.x, 0.0F) << parts[i].name;
    EXPECT_GE(rect.y, 0.0F) << parts[i].name;
    EXPECT_LE(rect.x + rect.width, window.width) << parts[i].name;
    EXPECT_LE(rect.y + rect.height, window.height) << parts[i].name;
    for (std::size_t j = 0; j < i; ++j) EXPECT_FALSE(overlap(rect, parts[j].rect)) << parts[i].name << " over " << parts[j].name;
  }
}

// Sizes as the window test finds them at 17 px, on a plain screen and on finer ones, in windows of 640 x 420 of their units and
// more, with the mouse anywhere.
TEST(ViewerLayout, PartsLieApartInAnyWindow) {
  for (const float scale : {1.0F, 1.5F, 2.0F}) {
    for (const Extent plain : {Extent{640, 420}, {800, 600}, {1280, 800}, {1920, 1080}, {640, 1400}}) {
      const Extent window{scale * plain.width, scale * plain.height};
      for (const float lab : {0.0F, 391.0F}) {
        for (const bool fallen : {false, true}) {
          SCOPED_TRACE(fmt::format("{} x {}, scale {}, lab {}, fallen {}", window.width, window.height, scale, lab, fallen));
          const auto scaled = [&](float width, float height) { return Extent{scale * width, scale * height}; };
          Wanted wanted;
          wanted.notices = scaled(lab > 0.0F ? 200.0F : 440.0F, 60.0F);
          wanted.bar = fallen ? Extent{} : scaled(lab > 0.0F ? 70.0F : 500.0F, 48.0F);
          wanted.legend = scaled(280.0F, 60.0F);
          wanted.lab = scaled(lab, lab > 0.0F ? 700.0F : 0.0F);
          wanted.card = fallen ? scaled(lab > 0.0F ? 200.0F : 380.0F, 90.0F) : Extent{};
          wanted.words = scaled(190.0F, 62.0F);
          for (float x = 0.0F; x <= 1.0F; x += 0.1F) {
            for (float y = 0.0F; y <= 1.0F; y += 0.1F)
              expectApartAndInside(layoutOf(window, wanted, {x * window.width, y * window.height}, scale * 10.0F), window);
          }
        }
      }
    }
  }
}

TEST(ViewerLayout, WordsLieBesideTheMouseWhereThereIsRoom) {
  Wanted wanted;
  wanted.words = {100.0F, 20.0F};
  const Layout layout = layoutOf({800.0F, 600.0F}, wanted, {400.0F, 300.0F}, 10.0F);
  EXPECT_EQ(layout.words.x, 420.0F);
  EXPECT_EQ(layout.words.y, 320.0F);
  const Layout right = layoutOf({800.0F, 600.0F}, wanted, {795.0F, 595.0F}, 10.0F);
  EXPECT_LT(right.words.y + right.words.height, 595.0F);  // not under the pointer
}

TEST(ViewerLayout, WhatFindsNoRoomIsLeftOut) {
  Wanted wanted;
  wanted.lab = {400.0F, 380.0F};
  wanted.words = {300.0F, 60.0F};
  EXPECT_TRUE(isEmpty(layoutOf({440.0F, 400.0F}, wanted, {200.0F, 200.0F}, 10.0F).words));
}

TEST(ViewerLayout, RectanglesThatTouchDoNotOverlap) {
  EXPECT_FALSE(overlap({0, 0, 10, 10}, {10, 0, 10, 10}));
  EXPECT_TRUE(overlap({0, 0, 10, 10}, {9, 9, 10, 10}));
  EXPECT_FALSE(overlap({0, 0, 10, 10}, {5, 5, 0, 10}));
}

}  // namespace
}  // namespace springtower
