#include "apps/viewer/session/game.h"
#include "solver/statics/statics.h"
#include "tests/apps/commands/loose_tower.h"
#include "tests/apps/viewer/session/viewer_play.h"

#include <cmath>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <limits>
#include <numbers>
#include <string>

namespace springtower {
namespace {

using ::testing::HasSubstr;

TEST(ViewerGame, BlocksBelowTheTopCompleteRowMayBeTaken) {
  const Session session(bitCodeScene("(111)-(1L1)-(111)-(110)"), 2);
  EXPECT_EQ(session.game.topRow, 2);
  for (std::size_t b = 0; b < 11; ++b) EXPECT_EQ(mayTake(session.game, blockId(b)), b < 6) << b;
  EXPECT_FALSE(mayTake(session.game, kFloor));
  EXPECT_THAT(describe(session.game), HasSubstr("Player 1"));
}

TEST(ViewerGame, WithoutPlayersEveryBlockMay) {
  const Session session(bitCodeScene(kLooseTower));
  for (std::size_t b = 0; b < 12; ++b) EXPECT_TRUE(mayTake(session.game, blockId(b)));
}

TEST(ViewerGame, AForbiddenBlockIsNotHeld) {
  Session session(bitCodeScene(kLooseTower), 2);
  Hand hand = handOn(session, 11);
  const Vec3 start = hand.place;
  lead(session, hand, {0.0, 0.0, 0.05}, 0.2);
  EXPECT_EQ(session.hold, Hold::none);
  EXPECT_LT((centre(session.simulation.state.position, 11) - start).norm(), 1e-3);
}

TEST(ViewerGame, DrawingPlacingAndUndoing) {
  Session session(bitCodeScene(kLooseTower), 2);
  wait(session, 60);
  const ParticleArray start = session.simulation.state.position;
  drawAndPlace(session, kLooseBlock, -1.0, kTop_m, true);
  EXPECT_EQ(session.game.phase, Phase::moving);
  EXPECT_EQ(session.game.block, blockId(kLooseBlock));
  EXPECT_FALSE(mayTake(session.game, blockId(0)));
  EXPECT_TRUE(mayTake(session.game, blockId(kLooseBlock)));
  wait(session, 90);
  EXPECT_EQ(session.game.moves, 1) << describe(session.game);
  EXPECT_EQ(session.game.player, 1);
  EXPECT_EQ(rowOf(session.simulation, kLooseBlock), 4);
  EXPECT_NEAR(centre(session.simulation.state.position, kLooseBlock).z(), kTop_m + 0.5 * kBlockHeight_m, 5e-4);

  // Undoing it brings back the state in which the turn began, bit for bit, and the turn with it.
  const auto frame = undoFrame(session);
  ASSERT_TRUE(frame);
  EXPECT_EQ(*frame, 0U);
  goTo(session, *frame);
  EXPECT_EQ(session.game.moves, 0);
  EXPECT_EQ(session.game.player, 0);
  EXPECT_FALSE(undoFrame(session));
  goTo(session, 60);
  EXPECT_EQ(session.simulation.state.position.component, start.component);
}

TEST(ViewerGame, AMoveThatIsNotFinishedCanBeTakenBack) {
  Session session(bitCodeScene(kLooseTower), 1);
  Hand hand = handOn(session, kLooseBlock);
  lead(session, hand, {0.0, -0.05, 0.0}, 0.15);
  EXPECT_EQ(session.game.phase, Phase::moving);
  ASSERT_TRUE(undoFrame(session));
  EXPECT_EQ(*undoFrame(session), 0U);
}

TEST(ViewerGame, WhoBringsTheTowerDownLoses) {
  Session session(bitCodeScene(kLooseTower), 3);
  Hand hand = handOn(session, 7);  // the middle of the third row, dragged off sideways with what lies on it
  hand.limit_n = 20.0;
  hand.place += Vec3(0.3, 0.3, 0.1);
  for (int i = 0; i < 240 && session.game.phase != Phase::over; ++i) step(session, {hand, session.tuning});
  EXPECT_EQ(session.game.phase, Phase::over);
  EXPECT_NE(session.game.fallen, blockId(7));
  EXPECT_THAT(describe(session.game), HasSubstr("Player 1 loses"));
  EXPECT_EQ(causeInWords(session.game), "Block 7 did it: it was taken out last.");
  for (std::size_t b = 0; b < 12; ++b) EXPECT_FALSE(mayTake(session.game, blockId(b)));
}

// Puts a block on the floor beside the tower, as it lies after a fall.
void layBeside(Simulation& simulation, std::size_t block) {
  const Vec3 way = Vec3(0.5, 0.0, 0.5 * kBlockHeight_m) - centre(simulation.state.position, block);
  for (std::size_t c = 0; c < kCorners; ++c)
    simulation.state.position.set(block, c, simulation.state.position.at(block, c) + Vec3(way.x(), 0.0, way.z()));
}

// As long as the next player has touched nothing, the tower stands or falls by what was laid on it last.
TEST(ViewerGame, WhatFallsUntouchedFallsByTheBlockLaidLast) {
  Session session(bitCodeScene(kLooseTower), 2);
  wait(session, 60);
  drawAndPlace(session, kLooseBlock, -1.0, kTop_m, true);
  wait(session, 90);
  ASSERT_EQ(session.game.moves, 1);
  ASSERT_EQ(session.game.player, 1);
  layBeside(session.simulation, 8);
  Game touched = session.game;
  EXPECT_FALSE(followGame(session.game, session.simulation, kFloor, session.frame));
  EXPECT_EQ(session.game.phase, Phase::over);
  EXPECT_THAT(describe(session.game), HasSubstr("Player 1 loses after 1 move: block 8 fell."));
  EXPECT_EQ(causeOf(session.game), blockId(kLooseBlock));
  EXPECT_EQ(causeInWords(session.game), "Block " + std::to_string(kLooseBlock) + " did it: it was laid on top last.");
  EXPECT_EQ(undoFrame(session), 0U) << "taking back undoes the move that brought it down";

  touched.held = blockId(3);
  EXPECT_FALSE(followGame(touched, session.simulation, kFloor, session.frame));
  EXPECT_THAT(describe(touched), HasSubstr("Player 2 loses"));
  EXPECT_EQ(causeInWords(touched), "Block 3 did it: it was pulled last.");
}

TEST(ViewerGame, WhatFallsBeforeAnybodyHasTouchedItFallsByItself) {
  Session session(bitCodeScene(kLooseTower), 2);
  EXPECT_EQ(causeInWords(session.game), "");
  layBeside(session.simulation, 5);
  EXPECT_FALSE(followGame(session.game, session.simulation, kFloor, session.frame));
  EXPECT_EQ(describe(session.game), "Nobody loses: block 5 fell.");
  EXPECT_EQ(causeOf(session.game), kFloor);
  EXPECT_EQ(causeInWords(session.game), "It fell by itself: nobody had touched a block.");
}

TEST(ViewerGame, TheDrawnBlockMayTouchTheFloor) {
  Session session(bitCodeScene(kLooseTower), 2);
  drawAndPlace(session, kLooseBlock, -1.0, kTop_m, false);
  Hand hand = handOn(session, kLooseBlock);
  lead(session, hand, {0.0, 0.0, 0.02}, 0.2);
  lead(session, hand, {0.0, -0.15, 0.0}, 0.3);
  lead(session, hand, {0.0, 0.0, -hand.place.z() + 0.5 * kBlockHeight_m}, 0.3);
  wait(session, 60);
  EXPECT_EQ(rowOf(session.simulation, kLooseBlock), 0);
  EXPECT_EQ(session.game.phase, Phase::moving) << describe(session.game);
  EXPECT_EQ(session.game.moves, 0);
}

TEST(ViewerGame, HintsKnowTheLooseBlockAndTheLoads) {
  Session session(bitCodeScene(kLooseTower));
  wait(session, 120);
  const std::vector<Hint> all = hints(session.simulation, session.contacts);
  const double weight = kBlockMass_kg * kStandardGravity_m_s2;
  double secondRow = 0.0;
  for (std::size_t b = 0; b < 12; ++b) EXPECT_EQ(all[b].loose, b == kLooseBlock) << b;
  for (const std::size_t b : {3U, 4U, 5U}) secondRow += all[b].load_n;
  EXPECT_NEAR(secondRow, 6.0 * weight, 0.02 * weight);
  EXPECT_NEAR(all[kLooseBlock].drag_n, 0.4 * weight, 0.02 * weight);
}

TEST(ViewerGame, AHintIsASentence) {
  EXPECT_EQ(inWords({blockId(3), 2.38, 2.9, false}, false), "Tight: 2.4 N to pull. The tower falls without it.");
  EXPECT_EQ(inWords({blockId(3), 0.08, 0.0, true}, true), "Loose: 0.1 N to pull. The tower stands without it.");
  EXPECT_EQ(inWords({blockId(3), 0.08, 0.0, true}, {}), "Loose: 0.1 N to pull.");
}

// One definition of loose: what statics of the scene as it is built and the hints of the scene at rest say of the same block.
TEST(ViewerGame, HintsAndStaticsAgreeOnWhatIsLoose) {
  const Scene scene = bitCodeScene(kLooseTower);
  const StaticScene statics = staticScene(scene);
  const std::vector<BlockLoad> loads = blockLoads(statics, contactLoads(statics));
  Session session(scene);
  wait(session, 120);
  const std::vector<Hint> all = hints(session.simulation, session.contacts);
  for (std::size_t b = 0; b < 12; ++b) EXPECT_EQ(all[b].loose, loads[b].loose) << b;
}

// The rule of a tower without offsets: it stands unless a row below the top is a lone outer block.
TEST(ViewerGame, StaticsOfRemovingABlock) {
  Session session(bitCodeScene("(011)-(111)-(010)-(111)"));
  wait(session, 30);
  const auto tilt = [&](std::size_t block) {
    const auto question = withoutBlock(session.simulation, session.contacts, blockId(block));
    return question ? tiltBorne(*question) : std::numeric_limits<double>::quiet_NaN();
  };
  EXPECT_LT(tilt(0), 0.0);  // leaves position 3 alone
  EXPECT_GT(tilt(1), 5.0);  // leaves the middle
  for (const std::size_t b : {2U, 3U, 4U}) EXPECT_GT(tilt(b), 0.0) << b;
  EXPECT_LT(tilt(5), 0.0);  // the only one of its row
  for (const std::size_t b : {6U, 7U, 8U}) EXPECT_GT(tilt(b), 0.0) << b;
}

// Two blocks one on the other: what is left is one block, which tips or slides as a block on a slope does.
TEST(ViewerGame, StaticsOfABlockThatIsLeft) {
  Session session(bitCodeScene("(010)-(010)"));
  wait(session, 30);
  const auto question = withoutBlock(session.simulation, session.contacts, blockId(1));
  ASSERT_TRUE(question);
  EXPECT_NEAR(tiltBorne(*question), std::atan(0.4) * 180.0 / std::numbers::pi, 0.1);
  Session alone(bitCodeScene("(010)"));
  EXPECT_FALSE(withoutBlock(alone.simulation, alone.contacts, blockId(0)));
}

}  // namespace
}  // namespace springtower
