#include "apps/viewer/view/words.h"

#include "tests/apps/commands/loose_tower.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace springtower {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

Viewer viewerOfLooseTower() {
  SceneChoice choice;
  choice.name = kLooseTower;
  choice.players = 1;
  Viewer viewer(choice, tuningOf(sceneOf(choice)));
  viewer.mode = Mode::play;
  for (int i = 0; i < 60; ++i) {
    viewer.session.frame_ms = 0.0;
    advance(viewer, viewer.session.scene.settings.frame_s);
  }
  return viewer;
}

void pointAt(Viewer& viewer, std::size_t block) {
  pictureOf(viewer);
  const auto at = seenAt(viewer.controls.camera, viewer.controls.viewport, centre(viewer.shown, block));
  pointerMoved(viewer.controls, viewer.session, at->x(), at->y());
  Pick pick;
  pick.block = blockId(block);
  viewer.controls.hover = pick;
}

TEST(ViewerWords, ThreeRulesUntilABlockWasHeld) {
  Viewer viewer = viewerOfLooseTower();
  pointerMoved(viewer.controls, viewer.session, 1.0, 1.0);
  const auto words = wordsAt(viewer, true);
  ASSERT_TRUE(words);
  EXPECT_EQ(words->lines.size(), kMostWords);
  EXPECT_FALSE(wordsAt(viewer, false));
  viewer.heldOnce = true;
  EXPECT_FALSE(wordsAt(viewer, true));
}

TEST(ViewerWords, ABlockUnderTheMouseSaysHowItIsHeld) {
  Viewer viewer = viewerOfLooseTower();
  viewer.heldOnce = true;
  pointAt(viewer, kLooseBlock);
  followStatics(viewer, true);
  auto words = wordsAt(viewer, true);
  ASSERT_TRUE(words);
  EXPECT_THAT(words->lines, ElementsAre(HasSubstr("Loose: "), "The tower stands without it."));
  pointAt(viewer, 11);  // of the uppermost full row
  words = wordsAt(viewer, true);
  ASSERT_TRUE(words);
  EXPECT_THAT(words->lines, ElementsAre("Not this one: only from below a full row."));
}

TEST(ViewerWords, MessagesFade) {
  Viewer viewer = viewerOfLooseTower();
  viewer.message = "written";
  advance(viewer, 0.01);
  EXPECT_EQ(notices(viewer).back().strength, 1.0);
  for (int i = 0; i < 28; ++i) advance(viewer, 0.1);
  EXPECT_LT(notices(viewer).back().strength, 1.0);
  EXPECT_GT(notices(viewer).back().strength, 0.0);
  for (int i = 0; i < 4; ++i) advance(viewer, 0.1);
  EXPECT_TRUE(viewer.message.empty());
}

// The ring is open towards the side on which the tower would go over, and says by how much it may lean.
TEST(ViewerWords, TheLegendSaysHowFarTheTowerMayLean) {
  Viewer viewer = viewerOfLooseTower();
  followStatics(viewer, true);
  ASSERT_TRUE(viewer.tower.known && viewer.tower.margin);
  EXPECT_GT(viewer.tower.margin->tilt_deg, 5.0);
  const std::vector<LegendRow> rows = legendRows(viewer);
  ASSERT_EQ(rows.size(), 1U);
  EXPECT_THAT(rows[0].after, HasSubstr("before it falls"));
  EXPECT_FALSE(pictureOf(viewer).ground.empty());
  viewer.mode = Mode::bare;
  EXPECT_TRUE(pictureOf(viewer).ground.empty());
}

TEST(ViewerReplayMode, WhatWasPlayedPassesAgainAndGoesOnFromThere) {
  Viewer viewer = viewerOfLooseTower();
  const std::uint64_t hash = stateHash(viewer.session.simulation);
  setMode(viewer, Mode::replay);
  EXPECT_EQ(viewer.session.frame, 0U);
  seek(viewer, 60);
  EXPECT_EQ(stateHash(viewer.session.simulation), hash);
  seek(viewer, 20);
  viewer.paused = false;
  for (int i = 0; i < 41 && viewer.session.frame < 60; ++i) {
    viewer.session.frame_ms = 0.0;
    advance(viewer, viewer.session.scene.settings.frame_s);
  }
  EXPECT_EQ(stateHash(viewer.session.simulation), hash);
  EXPECT_FALSE(viewer.replay->differs);
  setMode(viewer, Mode::play);
  EXPECT_FALSE(viewer.replay);
}

}  // namespace
}  // namespace springtower
