#include "core/error.h"
#include "core/scene/scene.h"
#include "tests/support/program.h"

#include <fstream>
#include <gmock/gmock.h>
#include <string>

namespace springtower {
namespace {

using testing::HasSubstr;
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
  EXPECT_THAT([] { withMoves(GetParam().moves); }, ThrowsMessage<InputError>(HasSubstr(GetParam().message)));
}

INSTANTIATE_TEST_SUITE_P(
    Scene, BadMovesTest,
    ::testing::Values(
        BadMoves{"NoKind", "[[moves]]\nrow = 1\n", "moves[0]: found no do, which is required"},
        BadMoves{"UnknownKind", "[[moves]]\ndo = \"throw\"\n", "moves[0].do: found 'throw', allowed take, put, put-aside"},
        BadMoves{"UnknownKey", kTake + "colour = 1\n", "unknown key 'colour' in moves[0], allowed do, row"},
        BadMoves{"NoDirection", "[[moves]]\ndo = \"take\"\nrow = 1\nposition = 2\n", "found no towards"},
        BadMoves{"Upwards", "[[moves]]\ndo = \"take\"\nrow = 1\nposition = 2\ntowards = \"+z\"\n",
                 "moves[0].towards: found '+z', allowed +x, -x, +y, -y"},
        BadMoves{"SpeedOfAPut", kTake + kPut + "speed_m_s = 1\n", "moves[1].speed_m_s: found speed_m_s for put, allowed row"},
        BadMoves{"TooFast", kTake + "speed_m_s = 3\n", "moves[0].speed_m_s: found 3, allowed 0.001 to 2 m/s"},
        BadMoves{"TextForANumber", kTake + "force_n = \"much\"\n", "moves[0].force_n: found the text 'much'"},
        BadMoves{"NobodyThere", "[[moves]]\ndo = \"take\"\nrow = 7\nposition = 2\ntowards = \"+x\"\n",
                 "moves[0]: found row 7, position 2 without a block"},
        BadMoves{"TwoInTheHand", kTake + kTake, "moves[1]: found a block to take with another in the hand"},
        BadMoves{"NothingInTheHand", kPut, "moves[0]: found nothing in the hand to put"},
        BadMoves{"OnABlock", kTake + "[[moves]]\ndo = \"put\"\nrow = 2\nposition = 1\n",
                 "moves[1]: found row 2, position 1 with a block, allowed a free place on a row"},
        BadMoves{"InTheAir", kTake + "[[moves]]\ndo = \"put\"\nrow = 5\nposition = 1\n",
                 "moves[1]: found row 5, position 1 on no row"},
        BadMoves{"NoFloor", kTake + "[[moves]]\ndo = \"put-aside\"\n[floor]\npresent = false\n", "found no floor"}),
    [](const auto& bad) { return bad.param.name; });

}  // namespace
}  // namespace springtower
