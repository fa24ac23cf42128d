#include "core/error.h"
#include "core/scene/scene.h"
#include "tests/support/program.h"
#include "tests/support/says.h"

#include <fstream>
#include <gmock/gmock.h>
#include <string>

namespace springtower {
namespace {

using testing::ThrowsMessage;

Scene withMoves(const std::string& moves) {
  const ScratchFolder folder;
  const std::string path = folder.file("moves.toml");
  std::ofstream(path) << "[tower]\nrows = 3\n" << moves;
  return sceneFromToml(path);
}

const std::string kTake = "[[moves]]\ndo = \"take\"\nrow = 1\nposition = 2\ntowards = \"-y\"\n";
const std::string kPut = "[[moves]]\ndo = \"put\"\nrow = 3\nposition = 1\n";

TEST(SceneMoves, AreReadInTheirOrderWithTheirDefaults) {
  const Scene scene =
      withMoves(kTake + "speed_m_s = 0.4\nforce_n = 2\nallowed_m = 1e-4\n" + kPut + "drop_m = 0.01\n" +
                "[[moves]]\ndo = \"take\"\nrow = 0\nposition = 1\ntowards = \"+x\"\n" + "[[moves]]\ndo = \"put-aside\"\n");
  ASSERT_EQ(scene.moves.size(), 4U);
  EXPECT_EQ(scene.moves[0].kind, MoveKind::take);
  EXPECT_EQ(scene.moves[0].row, 1);
  EXPECT_EQ(scene.moves[0].position, 2);
  EXPECT_EQ(scene.moves[0].towards, Vec3(-Vec3::UnitY()));
  EXPECT_EQ(scene.moves[0].speed_m_s, 0.4);
  EXPECT_EQ(scene.moves[0].limit_n, 2.0);
  EXPECT_EQ(scene.moves[0].allowed_m, 1e-4);
  EXPECT_EQ(scene.moves[1].kind, MoveKind::put);
  EXPECT_EQ(scene.moves[1].drop_m, 0.01);
  EXPECT_FALSE(scene.moves[1].allowed_m.has_value());
  EXPECT_EQ(scene.moves[2].speed_m_s, Move{}.speed_m_s);
  EXPECT_EQ(scene.moves[3].kind, MoveKind::putAside);
}

struct BadMoves {
  std::string name;
  std::string moves;
  std::string message;
};

class BadMovesTest : public ::testing::TestWithParam<BadMoves> {};

TEST_P(BadMovesTest, AreRefusedInOneLineThatNamesThem) {
  EXPECT_THAT([] { withMoves(GetParam().moves); }, ThrowsMessage<InputError>(says(GetParam().message)));
}

INSTANTIATE_TEST_SUITE_P(
    Scene, BadMovesTest,
    ::testing::Values(
        BadMoves{"NoKind", "[[moves]]\nrow = 1\n", "moves[0]: expected the key do, got none"},
        BadMoves{"UnknownKind", "[[moves]]\ndo = \"throw\"\n", "moves[0].do: expected take, put or put-aside, got 'throw'"},
        BadMoves{"UnknownKey", kTake + "colour = 1\n", "expected do, row, ... in moves[0], got the unknown key 'colour'"},
        BadMoves{"NoDirection", "[[moves]]\ndo = \"take\"\nrow = 1\nposition = 2\n", "expected the key towards, got none"},
        BadMoves{"Upwards", "[[moves]]\ndo = \"take\"\nrow = 1\nposition = 2\ntowards = \"+z\"\n",
                 "moves[0].towards: expected +x, -x, +y or -y, got '+z'"},
        BadMoves{"SpeedOfAPut", kTake + kPut + "speed_m_s = 1\n", "moves[1].speed_m_s: expected row, ... for put, got speed_m_s"},
        BadMoves{"TooFast", kTake + "speed_m_s = 3\n", "moves[0].speed_m_s: expected 0.001 to 2 m/s, got 3"},
        BadMoves{"TextForANumber", kTake + "force_n = \"much\"\n", "moves[0].force_n: expected ..., got the text 'much'"},
        BadMoves{"NobodyThere", "[[moves]]\ndo = \"take\"\nrow = 7\nposition = 2\ntowards = \"+x\"\n",
                 "moves[0]: expected a place of the tower that has a block, got row 7, position 2 without one"},
        BadMoves{"TwoInTheHand", kTake + kTake,
                 "moves[1]: expected put or put-aside before the next take, got take with a block in the hand"},
        BadMoves{"NothingInTheHand", kPut, "moves[0]: expected take before it, got nothing in the hand to put"},
        BadMoves{"OnABlock", kTake + "[[moves]]\ndo = \"put\"\nrow = 2\nposition = 1\n",
                 "moves[1]: expected a free place on a row, got row 2, position 1 with a block"},
        BadMoves{"InTheAir", kTake + "[[moves]]\ndo = \"put\"\nrow = 5\nposition = 1\n",
                 "moves[1]: expected ..., got row 5, position 1 on no row"},
        BadMoves{"NoFloor", kTake + "[[moves]]\ndo = \"put-aside\"\n[floor]\npresent = false\n",
                 "expected a floor to put a block on, got none"}),
    [](const auto& bad) { return bad.param.name; });

}  // namespace
}  // namespace springtower
