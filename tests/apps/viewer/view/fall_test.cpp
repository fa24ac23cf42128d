#include "apps/viewer/view/fall.h"

#include "apps/viewer/view/words.h"
#include "tests/apps/commands/loose_tower.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace springtower {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr std::size_t kDragged = 7;  // the middle of the third row

Viewer viewerInPlay(int players) {
  SceneChoice choice;
  choice.name = kLooseTower;
  choice.players = players;
  Viewer viewer(choice, tuningOf(sceneOf(choice)));
  viewer.mode = Mode::play;
  return viewer;
}

double frameOf(const Viewer& viewer) {
  return viewer.session.scene.settings.frame_s;
}

void pass(Viewer& viewer) {
  viewer.session.frame_ms = 0.0;  // what a slow machine leaves out would not repeat
  advance(viewer, frameOf(viewer));
}

// Drags a block off sideways with what lies on it, until a block is down.
void bringDown(Viewer& viewer) {
  Hand& hand = viewer.controls.hand;
  for (int i = 0; i < 70; ++i) pass(viewer);  // more than is shown again
  hand = handOn(viewer.session.simulation, blockId(kDragged), 20.0);
  hand.place += Vec3(0.3, 0.3, 0.1);
  viewer.limit_n = 20.0;
  viewer.controls.guide.block = hand.block;
  viewer.controls.guide.lead = Lead::freely;
  for (int i = 0; i < 400 && viewer.session.game.phase != Phase::over; ++i) pass(viewer);
  ASSERT_EQ(viewer.session.game.phase, Phase::over);
}

TEST(ViewerFall, StopsTheClockGoesBackAndPassesAtAQuarterOfItsSpeed) {
  Viewer viewer = viewerInPlay(1);
  bringDown(viewer);
  const std::uint64_t lost = viewer.session.frame;
  pass(viewer);
  EXPECT_EQ(viewer.fall.stage, FallStage::rewinding);
  EXPECT_EQ(viewer.fall.cause, blockId(kDragged));
  int rewinding = 0;
  int passing = 0;
  for (; viewer.fall.stage == FallStage::rewinding; ++rewinding) pass(viewer);
  const double first = viewer.fall.at;
  for (; viewer.fall.stage == FallStage::passing; ++passing) pass(viewer);
  EXPECT_EQ(viewer.session.frame, lost) << "the clock has to stand still meanwhile";
  EXPECT_NEAR(rewinding, 36, 3);  // 0.6 s
  EXPECT_NEAR(passing, (static_cast<double>(viewer.poses.count()) - 1.0 - first) / kFallRate, 2.0);
  EXPECT_GT(passing, 60);
  EXPECT_EQ(viewer.pacer.rate, kFallRate);
  int following = 0;
  for (; viewer.fall.stage == FallStage::following; ++following) pass(viewer);
  EXPECT_NEAR(following, kFallAfter_s / frameOf(viewer) / kFallRate, 8);
  EXPECT_EQ(viewer.fall.stage, FallStage::stopped);
  EXPECT_TRUE(viewer.paused);
  EXPECT_EQ(viewer.pacer.rate, 1.0);
}

TEST(ViewerFall, TheCardNamesTheBlockAndOffersWhatThereIs) {
  Viewer viewer = viewerInPlay(2);
  EXPECT_THAT(cardLines(viewer), IsEmpty());
  bringDown(viewer);
  pass(viewer);
  EXPECT_THAT(cardLines(viewer), IsEmpty());  // while it is shown
  skipFall(viewer);
  const std::vector<std::string> lines = cardLines(viewer);
  ASSERT_EQ(lines.size(), 2U);
  EXPECT_THAT(lines[0], HasSubstr("Player 1 loses after 0 moves: block"));
  EXPECT_EQ(lines[1], "Block 7 did it: it was taken out last.");
  const std::uint64_t end = viewer.session.frame;
  watchFall(viewer);
  EXPECT_EQ(viewer.fall.stage, FallStage::rewinding);
  for (int i = 0; i < 2000 && viewer.fall.stage != FallStage::stopped; ++i) pass(viewer);
  EXPECT_GE(viewer.session.frame, end);
  EXPECT_EQ(viewer.fall.stage, FallStage::stopped);
  undo(viewer);
  EXPECT_EQ(viewer.fall.stage, FallStage::none);
  EXPECT_EQ(viewer.session.game.phase, Phase::choose);
  EXPECT_FALSE(viewer.paused);
}

// The replay is of poses alone: the session goes on from where it stopped, and its record is what was played.
TEST(ViewerFall, ThePastIsShownAndNothingIsSteppedForIt) {
  Viewer viewer = viewerInPlay(1);
  bringDown(viewer);
  const std::uint64_t hash = stateHash(viewer.session.simulation);
  while (viewer.fall.stage != FallStage::passing) pass(viewer);
  EXPECT_TRUE(showsPast(viewer.fall));
  const Picture picture = pictureOf(viewer);
  EXPECT_EQ(picture.highlighted, static_cast<std::int32_t>(kDragged));
  EXPECT_GT((centre(viewer.shown, kDragged) - centre(viewer.session.simulation.state.position, kDragged)).norm(), 0.02);
  EXPECT_EQ(stateHash(viewer.session.simulation), hash);
}

// As it was at the start, bit for bit, and what is played from there is what it was. No equilibrium is searched for again.
TEST(ViewerFall, AgainAnswersAtOnce) {
  SceneChoice choice;
  choice.players = 1;
  choice.options.heightsSigma_m = kUsualSigma_m;
  Viewer viewer(choice, tuningOf(sceneOf(choice)));
  viewer.mode = Mode::play;
  prepareStart(viewer.session);
  for (int i = 0; i < 40; ++i) pass(viewer);
  const std::uint64_t hash = stateHash(viewer.session.simulation);
  skipFall(viewer);
  double least_s = 1e9;
  for (int i = 0; i < 5; ++i) {
    const auto start = std::chrono::steady_clock::now();
    again(viewer);
    pass(viewer);
    least_s = std::min(least_s, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
  }
  EXPECT_EQ(viewer.session.frame, 1U);
  for (int i = 1; i < 40; ++i) pass(viewer);
  EXPECT_EQ(stateHash(viewer.session.simulation), hash);
  EXPECT_EQ(viewer.session.log.size(), 40U);
  EXPECT_LT(least_s, viewer.session.scene.settings.frame_s);
}

TEST(ViewerFall, AgainEndsIt) {
  Viewer viewer = viewerInPlay(1);
  bringDown(viewer);
  pass(viewer);
  again(viewer);
  EXPECT_EQ(viewer.fall.stage, FallStage::none);
  EXPECT_FALSE(viewer.paused);
  EXPECT_EQ(viewer.pacer.rate, 1.0);
  EXPECT_EQ(viewer.session.game.phase, Phase::choose);
  EXPECT_EQ(viewer.session.frame, 0U);
}

// The camera looks across the way of the fall: it goes from one side of the picture to the other.
TEST(ViewerFall, TheBestSideIsSquareToTheFall) {
  const Session session(bitCodeScene(kLooseTower));
  const ParticleArray& before = session.simulation.state.position;
  for (const double direction : {0.0, 0.7, 2.0, -2.5}) {
    const Vec3 way(std::cos(direction), std::sin(direction), 0.0);
    ParticleArray after = before;
    for (std::size_t c = 0; c < kCorners; ++c) after.set(11, c, before.at(11, c) + 0.1 * way - Vec3(0.0, 0.0, 0.05));
    const Camera camera = bestSide({}, before, after);
    EXPECT_NEAR(std::abs(cameraFrame(camera).right.dot(way)), 1.0, 1e-6) << direction;
    for (std::size_t b = 0; b < 12; ++b) {
      const auto at = seenAt(camera, {800, 600}, centre(after, b));
      ASSERT_TRUE(at);
      EXPECT_TRUE(at->x() > 0 && at->x() < 800 && at->y() > 0 && at->y() < 600) << b;
    }
  }
}

TEST(ViewerFall, OutsideOfPlayNothingStops) {
  Viewer viewer = viewerInPlay(1);
  viewer.mode = Mode::lab;
  bringDown(viewer);
  for (int i = 0; i < 10; ++i) pass(viewer);
  EXPECT_EQ(viewer.fall.stage, FallStage::none);
  EXPECT_FALSE(viewer.paused);
}

}  // namespace
}  // namespace springtower
