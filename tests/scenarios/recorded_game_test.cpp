// The game that `springtower profile` and the instruction counts play: what happens in it.
#include "scenarios/recorded/recorded_game.h"

#include "solver/hand/played_frame.h"
#include "solver/world/simulation.h"

#include <cmath>
#include <cstddef>
#include <gtest/gtest.h>
#include <vector>

namespace springtower {
namespace {

// Frames in a row with the same block in the hand, on a line or carried.
struct Held {
  BlockId block;
  bool drawn;
  std::size_t begin;
  std::size_t end;
};

std::vector<Held> holds() {
  std::vector<Held> all;
  const std::vector<LoggedFrame>& frames = recordedGame().frames;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const Hand& hand = frames[i].input.hand;
    if (hand.block == kFloor) continue;
    const bool drawn = !hand.line.isZero(0.0);
    const bool goesOn = !all.empty() && all.back().end == i && all.back().block == hand.block && all.back().drawn == drawn;
    if (goesOn) {
      ++all.back().end;
    } else {
      all.push_back({hand.block, drawn, i, i + 1});
    }
  }
  return all;
}

Vec3 placeIn(std::size_t frame) {
  return recordedGame().frames[frame].input.hand.place;
}

// A steady pull would have the largest speed from begin to end.
void expectHesitation(const Held& draw) {
  constexpr double kSlow_m_s = 0.01;
  const Vec3 line = recordedGame().frames[draw.begin].input.hand.line;
  const double frame_s = recordedTower().settings.frame_s;
  int back = 0;
  int slow = 0;
  for (std::size_t i = draw.begin + 1; i < draw.end; ++i) {
    const double speed_m_s = (placeIn(i) - placeIn(i - 1)).dot(line) / frame_s;
    back += speed_m_s < -kSlow_m_s ? 1 : 0;
    slow += std::abs(speed_m_s) < kSlow_m_s ? 1 : 0;
  }
  EXPECT_GE(back, 5);
  EXPECT_GE(slow, 15);
}

TEST(RecordedGame, IsOfTheFullTowerAsTheViewerPlaysIt) {
  const Recording& game = recordedGame();
  EXPECT_EQ(game.choice.name, "tower:18");
  EXPECT_EQ(game.choice.players, 1);
  EXPECT_EQ(game.choice.options.heightsSigma_m, kUsualSigma_m);
  EXPECT_EQ(recordedTower().blocks.size(), 54U);
  EXPECT_EQ(tuningOf(recordedTower()), tuningOf(sceneOf(game.choice)));
  for (const LoggedFrame& frame : game.frames) {
    ASSERT_EQ(frame.input.tuning, game.frames.front().input.tuning);
    ASSERT_FALSE(frame.hash);
  }
}

TEST(RecordedGame, DrawsAndCarriesTwoBlocksAndDrawsAThird) {
  const std::vector<Held> all = holds();
  ASSERT_EQ(all.size(), 5U);
  for (const std::size_t first : {0U, 2U}) {
    EXPECT_EQ(all[first].block, all[first + 1].block);
    EXPECT_TRUE(all[first].drawn);
    EXPECT_FALSE(all[first + 1].drawn);
    EXPECT_EQ(all[first].end, all[first + 1].begin);
    expectHesitation(all[first]);
    EXPECT_GT(placeIn(all[first + 1].end - 1).z(), 18 * kBlockHeight_m) << "laid on top";
  }
  EXPECT_TRUE(all[4].drawn);
  EXPECT_NE(all[0].block, all[2].block);
}

// Of the frames that are counted.
TEST(RecordedGame, ItsPartsAreWhatTheyAreCalled) {
  const std::vector<Held> all = holds();
  ASSERT_EQ(all.size(), 5U);
  const auto parts = gameParts();
  ASSERT_EQ(parts.size(), 3U);
  EXPECT_EQ(parts[0].first, all[0].begin + 1);
  EXPECT_EQ(parts[0].last, all[0].end);
  EXPECT_EQ(parts[1].first, all[1].begin + 1);
  EXPECT_GT(parts[1].last, all[1].end) << "it is let go";
  EXPECT_EQ(parts[2].first, all[4].begin + 1);
  EXPECT_LT(parts[2].last, all[4].end);
}

TEST(RecordedGame, LaysTwoBlocksOnTopAndBringsTheTowerDown) {
  const std::vector<Held> all = holds();
  ASSERT_EQ(all.size(), 5U);
  Simulation simulation(recordedTower());
  const ParticleArray start = simulation.state.position;
  Grip grip;
  std::vector<ContactForce> contacts;
  const auto fallen = [&] {
    int count = 0;
    for (std::size_t b = 0; b < start.blockCount(); ++b)
      count += centre(simulation.state.position, b).z() < centre(start, b).z() - 0.5 * kBlockHeight_m ? 1 : 0;
    return count;
  };
  for (const LoggedFrame& frame : recordedGame().frames) {
    stepPlayed(frame.input.hand, grip, contacts, simulation);
    if (simulation.frame != all[4].begin) continue;
    EXPECT_EQ(fallen(), 0);
    for (const Held& held : {all[0], all[2]})
      EXPECT_NEAR(centre(simulation.state.position, index(held.block)).z(), 18.5 * kBlockHeight_m, 0.2 * kBlockHeight_m);
  }
  EXPECT_GT(fallen(), 20);
}

}  // namespace
}  // namespace springtower
