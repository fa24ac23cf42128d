#include "solver/hand/moves.h"

#include "core/scene/scene.h"
#include "solver/runner/run.h"
#include "tests/solver/hand/take.h"

#include <gtest/gtest.h>
#include <string>
#include <utility>

namespace springtower {
namespace {

Move put(int row, int position, double drop_m = 0.0) {
  Move move;
  move.kind = MoveKind::put;
  move.row = row;
  move.position = position;
  move.drop_m = drop_m;
  return move;
}

RunResult play(Simulation& simulation) {
  RunOptions options;
  options.seconds = 120.0;
  options.measureEveryFrame = false;
  return runScene(simulation, options);
}

// A loose block is drawn out and placed on top: no other block moves by more than the tolerance, it lies where it was placed, and
// it counts for `standing` in its new place.
TEST(Moves, ALooseBlockGoesToTheTopAndMovesNobody) {
  Scene scene = bitCodeScene("(111)-(1L1)-(111)");
  scene.moves = {take(1, 2, Vec3::UnitY()), put(3, 2)};
  Simulation simulation(scene);
  const RunResult result = play(simulation);
  ASSERT_EQ(result.moves.size(), 2U);
  for (const MoveResult& move : result.moves) {
    EXPECT_TRUE(move.done);
    EXPECT_TRUE(move.rested);
    EXPECT_LT(move.moved_m, toleranceOf(scene));
    EXPECT_EQ(move.statics, Rest::stands);
    EXPECT_LE(move.force_n, 5.0);
    EXPECT_EQ(move.block, blockId(4));
  }
  const Vec3 place = centre(simulation.state.position, 4);
  EXPECT_NEAR(place.x(), 0.0, 2e-4);
  EXPECT_NEAR(place.y(), 0.0, 2e-4);
  EXPECT_NEAR(place.z(), 3.5 * kBlockHeight_m - 0.5 * 0.0003, 2e-4);
  EXPECT_LT(result.moves[1].slide_m, 1e-4);
  EXPECT_TRUE(result.standing.stands);
}

// The middle block under the top row: its overhang grows as it comes out, and its end must not lift the light blocks on it, which
// rest on it with a third of their weight, and drag them along. No other block moves by more than the tolerance.
TEST(Moves, ABlockUnderTheTopRowLeavesItWhereItIs) {
  for (const char* code : {"(111)-(111)-(111)", "(111)-(101)-(111)-(111)-(111)", "(111)-(111)-(110)-(111)-(111)"}) {
    Scene scene = bitCodeScene(code);
    const int row = scene.blocks.back().row - 1;
    scene.moves = {take(row, 2, row % 2 == 0 ? Vec3::UnitX() : Vec3::UnitY())};
    Simulation simulation(scene);
    const RunResult result = play(simulation);
    ASSERT_EQ(result.moves.size(), 1U) << code;
    EXPECT_TRUE(result.moves[0].done && result.moves[0].rested) << code;
    EXPECT_LT(result.moves[0].moved_m, toleranceOf(scene)) << code;
    EXPECT_TRUE(result.standing.stands) << code;
  }
}

// The same under the top row of 18 swaying rows without sleep: a hand that held the block level against the leaning row under it
// dragged the top row along.
TEST(Moves, ABlockUnderTheTopRowOfASwayingTowerLeavesItWhereItIs) {
  Scene scene = towerScene(18);
  scene.settings.sleep = Sleep::off;
  scene.moves = {take(16, 2, Vec3::UnitX())};
  Simulation simulation(scene);
  const RunResult result = play(simulation);
  ASSERT_EQ(result.moves.size(), 1U);
  EXPECT_TRUE(result.moves[0].done && result.moves[0].rested);
  EXPECT_LT(result.moves[0].moved_m, toleranceOf(scene));
}

// The lone block under others, at the side: statics predicts that the rest falls, and it does.
TEST(Moves, TakingTheLastSupportBringsTheTowerDown) {
  Scene scene = bitCodeScene("(111)-(110)-(111)");
  Move away;
  away.kind = MoveKind::putAside;
  scene.moves = {take(1, 2, Vec3::UnitY()), away};
  for (Move& move : scene.moves) move.limit_n = 20.0;
  Simulation simulation(scene);
  const RunResult result = play(simulation);
  EXPECT_FALSE(result.standing.stands);
  EXPECT_LT(result.moves.size(), 2U);
  std::erase_if(scene.blocks, [](const BlockSpec& block) { return block.row == 1 && block.position == 2; });
  scene.moves.clear();
  EXPECT_EQ(staticScene(scene).rest, Rest::falls);
}

// A block taken out and put aside is excluded from the verdict, lies on the floor beside the tower, and the rest stands.
TEST(Moves, APutAsideBlockLiesOnTheFloor) {
  Scene scene = towerScene(4);
  Move away;
  away.kind = MoveKind::putAside;
  scene.moves = {take(2, 2, Vec3::UnitX()), away};
  Simulation simulation(scene);
  const RunResult result = play(simulation);
  ASSERT_EQ(result.moves.size(), 2U);
  EXPECT_TRUE(result.moves[1].done);
  EXPECT_TRUE(result.standing.stands);
  EXPECT_FALSE(result.creep_m.has_value());
  const Vec3 place = centre(simulation.state.position, 7);
  EXPECT_NEAR(place.z(), 0.5 * kBlockHeight_m, 1e-4);
  EXPECT_GT(place.head<2>().norm(), 0.2);
}

// A block of the bottom row touches the floor until the end; it counts as free nevertheless.
TEST(Moves, ABlockIsDrawnAlongTheFloor) {
  Scene scene = towerScene(3);
  scene.moves = {take(0, 3, Vec3::UnitY()), put(3, 2)};
  Simulation simulation(scene);
  const RunResult result = play(simulation);
  ASSERT_EQ(result.moves.size(), 2U);
  EXPECT_TRUE(result.moves[1].done);
  EXPECT_TRUE(result.standing.stands);
}

// A block that the hand is too weak to draw stays, and the sequence ends there.
TEST(Moves, AWeakHandStops) {
  Scene scene = towerScene(6);
  scene.moves = {take(0, 2, Vec3::UnitX(), 2.0)};
  scene.moves[0].limit_n = 0.1;
  Simulation simulation(scene);
  const RunResult result = play(simulation);
  ASSERT_EQ(result.moves.size(), 1U);
  EXPECT_FALSE(result.moves[0].done);
  EXPECT_FALSE(isWithin(scene.moves[0], result.moves[0]));
  EXPECT_LT(result.moves[0].moved_m, 1e-4);
  EXPECT_TRUE(result.standing.stands);
}

// The removals `removal-0-2` of the reference set, by pulling: statics predicts that the tower stands after five of them, and not
// after the sixth. Outer blocks are drawn sideways, the shorter way: along their length they would rotate the blocks on their
// end. The second one is jerked out: steady friction would be 0.69 N eight rows above the place of the first, a torque of 0.10 N
// m about the edge of what is left there, and the twelve rows on it support 0.09.
TEST(Moves, BlocksPulledOutOneByOneLeaveWhatStaticsSays) {
  Scene scene = towerScene(18);
  Move away;
  away.kind = MoveKind::putAside;
  const std::pair<int, int> places[] = {{5, 1}, {13, 1}, {3, 2}, {15, 2}, {0, 2}, {15, 1}};
  for (const auto& [row, position] : places) {
    const Vec3 length = row % 2 == 0 ? Vec3::UnitX() : Vec3::UnitY();
    const Vec3 outwards = (position - 2) * (row % 2 == 0 ? Vec3::UnitY() : Vec3::UnitX());
    scene.moves.push_back(take(row, position, position == 2 ? length : outwards));
    scene.moves.push_back(away);
  }
  for (Move& move : scene.moves) move.limit_n = 20.0;
  scene.moves[2].speed_m_s = 1.5;
  Simulation simulation(scene);
  const RunResult result = play(simulation);
  ASSERT_GE(result.moves.size(), 10U);
  EXPECT_LT(result.moves.size(), 12U);
  for (std::size_t i = 0; i < 10; ++i) EXPECT_TRUE(result.moves.at(i).done);
  EXPECT_FALSE(result.standing.stands);
}

// The report's sequence 6.1.2 (scenes/moves.toml) to its end: every block reaches its place, no other moves by more than in the
// real tower, and the tower stands.
TEST(Moves, TheReportsSequenceEndsStanding) {
  const Scene scene = sceneFromName(SPRINGTOWER_SOURCE_DIR "/scenes/moves.toml");
  ASSERT_EQ(scene.moves.size(), 12U);
  Simulation simulation(scene);
  const RunResult result = play(simulation);
  EXPECT_TRUE(result.standing.stands) << describe(result.standing);
  ASSERT_EQ(result.moves.size(), 12U);
  for (std::size_t step = 0; step < 12; ++step) {
    EXPECT_TRUE(result.moves[step].done && result.moves[step].rested) << step;
    EXPECT_TRUE(isWithin(scene.moves[step], result.moves[step])) << step << ": " << result.moves[step].moved_m;
  }
}

}  // namespace
}  // namespace springtower
