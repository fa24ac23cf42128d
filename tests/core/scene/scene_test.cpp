#include "core/scene/scene.h"

#include "core/error.h"

#include <cmath>
#include <gmock/gmock.h>
#include <limits>
#include <numbers>

namespace springtower {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

constexpr double kPitch_m = 0.02715;

double bottomOf(const BlockSpec& block) {
  return block.centre.z() - 0.5 * block.dimensions.z();
}
double topOf(const BlockSpec& block) {
  return block.centre.z() + 0.5 * block.dimensions.z();
}
const BlockSpec& at(const Scene& scene, int row, int position) {
  for (const BlockSpec& block : scene.blocks) {
    if (block.row == row && block.position == position) return block;
  }
  throw std::runtime_error("no such block");
}

TEST(Tower, EighteenRowsAreFiftyFourOfTheGamesBlocks) {
  const Scene scene = towerScene(18);
  EXPECT_EQ(scene.name, "tower:18");
  ASSERT_EQ(scene.blocks.size(), 54U);
  for (const BlockSpec& block : scene.blocks) {
    EXPECT_EQ(block.dimensions, Vec3(0.081, 0.0267, 0.0182));
    EXPECT_EQ(block.mass, 0.0196);
    EXPECT_EQ(block.velocity, Vec3::Zero());
    EXPECT_EQ(block.spin, Vec3::Zero());
  }
  EXPECT_TRUE(scene.floor);
  EXPECT_EQ(scene.staticFriction, 0.4);
  EXPECT_EQ(scene.kineticFriction, 0.4);
  EXPECT_EQ(scene.gravity.magnitude, 9.81);
}

// The coordinates that the verdicts of statics were computed for.
TEST(Tower, PlacesAreTheReferenceOnes) {
  const Scene scene = towerScene(18);
  for (std::size_t b = 0; b < scene.blocks.size(); ++b) {
    const BlockSpec& block = scene.blocks[b];
    EXPECT_EQ(block.row, static_cast<int>(b) / 3);
    EXPECT_EQ(block.position, static_cast<int>(b) % 3 + 1);
    const bool even = block.row % 2 == 0;
    const double across = kPitch_m * (block.position - 2);
    const Vec3 expected(even ? 0.0 : across, even ? across : 0.0, 0.0182 * (block.row + 0.5));
    EXPECT_LT((block.centre - expected).norm(), 1e-15) << "block " << b;
    const Vec3 alongLength = block.orientation * Vec3::UnitX();
    EXPECT_LT((alongLength - (even ? Vec3::UnitX() : Vec3::UnitY())).norm(), 1e-15) << "block " << b;
    EXPECT_LT((block.orientation * Vec3::UnitZ() - Vec3::UnitZ()).norm(), 1e-15) << "block " << b;
  }
}

TEST(Tower, RowsTouchToTheLastBitOrTheNext) {
  const Scene scene = towerScene(200);
  EXPECT_EQ(bottomOf(scene.blocks.front()), 0.0);
  for (int row = 1; row < 200; ++row) {
    const double below = topOf(at(scene, row - 1, 1));
    EXPECT_NEAR(bottomOf(at(scene, row, 1)), below, below * std::numeric_limits<double>::epsilon()) << "row " << row;
  }
}

TEST(Tower, ThreeBlocksSpanALengthSoThatTheCornersOfAllRowsAreFlush) {
  const Scene scene = towerScene(2);
  EXPECT_NEAR(at(scene, 0, 3).centre.y() + 0.5 * kBlockWidth_m, 0.5 * kBlockLength_m, 1e-16);
  EXPECT_NEAR(at(scene, 0, 2).centre.y() - at(scene, 0, 1).centre.y() - kBlockWidth_m, 0.00045, 1e-16);
}

TEST(Tower, HasOneToTwoThousandRows) {
  EXPECT_EQ(towerScene(1).blocks.size(), 3U);
  EXPECT_EQ(towerScene(2000).blocks.size(), 6000U);
  EXPECT_THAT([] { towerScene(0); }, ThrowsMessage<InputError>("tower:0: expected 1 to 2000 rows, got 0"));
  EXPECT_THAT([] { towerScene(2001); }, ThrowsMessage<InputError>("tower:2001: expected 1 to 2000 rows, got 2001"));
}

TEST(BitCode, NamesThePresentBlocksFromTheBottom) {
  const Scene scene = bitCodeScene("(010)-(010)-(011)-(010)-(101)");
  EXPECT_EQ(scene.name, "(010)-(010)-(011)-(010)-(101)");
  const std::vector<std::pair<int, int>> expected = {{0, 2}, {1, 2}, {2, 2}, {2, 3}, {3, 2}, {4, 1}, {4, 3}};
  ASSERT_EQ(scene.blocks.size(), expected.size());
  for (std::size_t b = 0; b < expected.size(); ++b) {
    EXPECT_EQ(scene.blocks[b].row, expected[b].first);
    EXPECT_EQ(scene.blocks[b].position, expected[b].second);
  }
}

TEST(BitCode, FullCodeIsTheTower) {
  const Scene code = bitCodeScene("(111)-(111)");
  const Scene tower = towerScene(2);
  for (std::size_t b = 0; b < 6; ++b) EXPECT_EQ(code.blocks[b].centre, tower.blocks[b].centre);
}

TEST(BitCode, TypoIsNamedWithItsPlace) {
  const std::pair<const char*, const char*> typos[] = {
      {"(010)-(0120)", "bit code '(010)-(0120)': character 10: expected 0, 1 or L, got '2'"},
      {"(010)-(0110)", "bit code '(010)-(0110)': character 11: expected ), got '0'"},
      {"(010)-(01)", "bit code '(010)-(01)': character 10: expected 0, 1 or L, got ')'"},
      {"(010)-(01", "bit code '(010)-(01': character 10: expected 0, 1 or L, got the end"},
      {"(010)(010)", "bit code '(010)(010)': character 6: expected - or the end, got '('"},
      {"(010)-", "bit code '(010)-': character 7: expected (, got the end"},
      {"(010) ", "bit code '(010) ': character 6: expected - or the end, got ' '"},
      {"(01l)", "bit code '(01l)': character 4: expected 0, 1 or L, got 'l'"},
      {"(0\n0)", "bit code '(0\\x0a0)': character 3: expected 0, 1 or L, got '\\x0a'"},
      {"", "bit code '': character 1: expected (, got the end"},
      {"(010)-(000)-(010)",
       "bit code '(010)-(000)-(010)': character 8: expected at least one block in every row, got a row without blocks"},
  };
  for (const auto& [code, message] : typos) {
    EXPECT_THAT([typo = code] { bitCodeScene(typo); }, ThrowsMessage<InputError>(message));
  }
}

TEST(BitCode, HasAtMostTwoThousandRows) {
  std::string code = "(010)";
  for (int row = 1; row < 2000; ++row) code += "-(010)";
  EXPECT_EQ(bitCodeScene(code).blocks.size(), 2000U);
  EXPECT_THAT([&] { bitCodeScene(code + "-(010)"); },
              ThrowsMessage<InputError>(HasSubstr("character 12000: expected 1 to 2000 rows, got more")));
}

TEST(LooseBlocks, AreLowerAndCarryNothingAtFirst) {
  const Scene scene = bitCodeScene("(1L1)-(111)");
  EXPECT_NEAR(at(scene, 0, 2).dimensions.z(), 0.0182 - 0.0003, 1e-17);
  EXPECT_NEAR(bottomOf(at(scene, 0, 2)), 0.0, 1e-17);
  EXPECT_EQ(bottomOf(at(scene, 1, 1)), topOf(at(scene, 0, 1)));
  EXPECT_NEAR(bottomOf(at(scene, 1, 1)) - topOf(at(scene, 0, 2)), 0.0003, 1e-16);
}

TEST(LooseBlocks, AreAsLowAsTheOptionsSay) {
  TowerOptions options;
  options.loose = {{0, 1, 0.0005}, {0, 2, 0.001}};
  const Scene scene = bitCodeScene("(1L1)", options);
  EXPECT_NEAR(at(scene, 0, 1).dimensions.z(), 0.0177, 1e-17);
  EXPECT_NEAR(at(scene, 0, 2).dimensions.z(), 0.0172, 1e-17);
  EXPECT_EQ(at(scene, 0, 3).dimensions.z(), 0.0182);
}

TEST(LooseBlocks, ThatAreARowOfTheirOwnLowerTheRowsAbove) {
  const Scene scene = bitCodeScene("(0L0)-(010)");
  EXPECT_NEAR(bottomOf(at(scene, 1, 2)), 0.0179, 1e-17);
}

TEST(Offsets, MoveABlockInItsPlane) {
  TowerOptions options;
  options.offsets = {{1, 3, 0.002, -0.01}};
  const Scene moved = bitCodeScene("(111)-(101)", options);
  const Scene nominal = bitCodeScene("(111)-(101)");
  for (std::size_t b = 0; b < nominal.blocks.size(); ++b) {
    const Vec3 expected = b == 4 ? Vec3(0.002, -0.01, 0.0) : Vec3(Vec3::Zero());
    EXPECT_LT((moved.blocks[b].centre - nominal.blocks[b].centre - expected).norm(), 1e-17) << "block " << b;
  }
}

TEST(Offsets, AndLooseBlocksMustNameAPresentBlockOnce) {
  const auto offset = [](std::vector<BlockOffset> offsets) {
    TowerOptions options;
    options.offsets = std::move(offsets);
    return [options] { bitCodeScene("(111)-(101)", options); };
  };
  const std::string allowed = ": expected rows 0 to 1 and positions 1 to 3 where a block is present, got no block there";
  for (const auto& [row, position] : {std::pair{1, 2}, {2, 1}, {-1, 1}, {0, 0}, {0, 4}}) {
    EXPECT_THAT(offset({{row, position, 0.0, 0.0}}),
                ThrowsMessage<InputError>("(111)-(101): offset of row " + std::to_string(row) + ", position " +
                                          std::to_string(position) + allowed));
  }
  EXPECT_THAT(offset({{0, 1, 0.0, 0.0}, {0, 1, 0.001, 0.0}}),
              ThrowsMessage<InputError>("(111)-(101): offset of row 0, position 1: expected once, got it twice"));
  EXPECT_THAT(offset({{0, 1, std::numeric_limits<double>::quiet_NaN(), 0.0}}),
              ThrowsMessage<InputError>("(111)-(101): offset of row 0, position 1: dx: expected -1 to 1 m, got nan"));
  TowerOptions options;
  options.loose = {{1, 2, 0.0003}};
  EXPECT_THAT([&] { bitCodeScene("(111)-(101)", options); },
              ThrowsMessage<InputError>("(111)-(101): loose block at row 1, position 2" + allowed));
  options.loose = {{1, 1, 0.02}};
  EXPECT_THAT(
      [&] { bitCodeScene("(111)-(101)", options); },
      ThrowsMessage<InputError>("(111)-(101): loose block at row 1, position 1: lower by: expected 0 to 0.009 m, got 0.02"));
}

TEST(Offsets, MayNotPushBlocksIntoOneAnother) {
  TowerOptions options;
  options.offsets = {{0, 1, 0.0, 0.001}};
  EXPECT_THAT(
      [&] { bitCodeScene("(111)-(101)", options); },
      ThrowsMessage<InputError>("(111)-(101): block 0 (row 0, position 1) and block 1 (row 0, position 2): expected a start up "
                                "to 0.2 mm inside each other, as at rest, got 0.55 mm"));
}

TEST(UnevenRows, StandOnTheHighestBlockBelow) {
  TowerOptions options;
  options.heightsSigma_m = 0.0002;
  const Scene scene = towerScene(18, options);
  double highest = 0.0;
  for (int row = 0; row < 18; ++row) {
    double top = 0.0;
    for (int position = 1; position <= 3; ++position) {
      EXPECT_NEAR(bottomOf(at(scene, row, position)), highest, 1e-16);
      top = std::max(top, topOf(at(scene, row, position)));
    }
    highest = top;
  }
}

TEST(UnevenRows, DropFromTheStartGap) {
  TowerOptions options;
  options.startGap_m = 0.005;
  const Scene scene = towerScene(4, options);
  EXPECT_EQ(bottomOf(at(scene, 0, 1)), 0.0);
  for (int row = 1; row < 4; ++row) EXPECT_NEAR(bottomOf(at(scene, row, 2)) - topOf(at(scene, row - 1, 2)), 0.005, 1e-16);
}

TEST(Variation, HasTheGivenDeviationIsCutOffAtThreeAndUncorrelated) {
  TowerOptions options;
  options.heightsSigma_m = 0.0004;
  options.massSigma_kg = 0.00185;
  const Scene scene = towerScene(2000, options);
  double heights[2] = {};
  double masses[2] = {};
  double product = 0.0;
  for (const BlockSpec& block : scene.blocks) {
    const double height = (block.dimensions.z() - kBlockHeight_m) / 0.0004;
    const double mass = (block.mass - kBlockMass_kg) / 0.00185;
    EXPECT_LE(std::abs(height), 3.0 + 1e-12);
    EXPECT_LE(std::abs(mass), 3.0 + 1e-12);
    heights[0] += height / 6000.0;
    heights[1] += height * height / 6000.0;
    masses[0] += mass / 6000.0;
    masses[1] += mass * mass / 6000.0;
    product += height * mass / 6000.0;
  }
  // Four standard errors; the cut takes 1.3 % of the variance.
  const double error = 4.0 / std::sqrt(6000.0);
  EXPECT_NEAR(heights[0], 0.0, error);
  EXPECT_NEAR(masses[0], 0.0, error);
  EXPECT_NEAR(heights[1], 0.99, error * std::numbers::sqrt2);
  EXPECT_NEAR(masses[1], 0.99, error * std::numbers::sqrt2);
  EXPECT_NEAR(product, 0.0, error);
}

TEST(Variation, OfOneQuantityDoesNotChangeAnother) {
  TowerOptions heights;
  heights.heightsSigma_m = 0.0002;
  TowerOptions both = heights;
  both.massSigma_kg = 0.001;
  TowerOptions masses;
  masses.massSigma_kg = 0.001;
  const Scene withHeights = towerScene(6, heights);
  const Scene withBoth = towerScene(6, both);
  const Scene withMasses = towerScene(6, masses);
  for (std::size_t b = 0; b < 18; ++b) {
    EXPECT_EQ(withHeights.blocks[b].dimensions, withBoth.blocks[b].dimensions);
    EXPECT_EQ(withMasses.blocks[b].mass, withBoth.blocks[b].mass);
    EXPECT_NE(withBoth.blocks[b].dimensions.z(), kBlockHeight_m);
    EXPECT_NE(withBoth.blocks[b].mass, kBlockMass_kg);
  }
}

TEST(Variation, OfAPlaceIsTheSameWhateverOtherBlocksArePresent) {
  TowerOptions options;
  options.heightsSigma_m = 0.0002;
  options.massSigma_kg = 0.001;
  const Scene full = bitCodeScene("(111)-(111)-(111)", options);
  const Scene gaps = bitCodeScene("(101)-(010)-(001)", options);
  for (const BlockSpec& block : gaps.blocks) {
    EXPECT_EQ(block.dimensions, at(full, block.row, block.position).dimensions);
    EXPECT_EQ(block.mass, at(full, block.row, block.position).mass);
  }
}

TEST(Variation, FollowsTheSeed) {
  TowerOptions options;
  options.heightsSigma_m = 0.0002;
  options.massSigma_kg = 0.001;
  const Scene first = towerScene(3, options);
  options.seed = 1;
  const Scene again = towerScene(3, options);
  options.seed = 2;
  const Scene other = towerScene(3, options);
  for (std::size_t b = 0; b < 9; ++b) {
    EXPECT_EQ(first.blocks[b].dimensions, again.blocks[b].dimensions);
    EXPECT_EQ(first.blocks[b].mass, again.blocks[b].mass);
    EXPECT_NE(first.blocks[b].dimensions, other.blocks[b].dimensions);
    EXPECT_NE(first.blocks[b].mass, other.blocks[b].mass);
  }
}

TEST(Variation, IsHeldToItsLimits) {
  TowerOptions options;
  options.heightsSigma_m = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT([&] { towerScene(3, options); },
              ThrowsMessage<InputError>("tower:3: standard deviation of the heights: expected 0 to 0.003 m, got nan"));
  options = {};
  options.massSigma_kg = -0.001;
  EXPECT_THAT([&] { towerScene(3, options); },
              ThrowsMessage<InputError>("tower:3: standard deviation of the masses: expected 0 to 0.0059 kg, got -0.001"));
  options = {};
  options.startGap_m = 5.0;
  EXPECT_THAT([&] { towerScene(3, options); }, ThrowsMessage<InputError>("tower:3: start gap: expected 0 to 1 m, got 5"));
}

TEST(SceneName, IsATowerACodeOrAFile) {
  EXPECT_EQ(sceneFromName("tower:4").blocks.size(), 12U);
  EXPECT_EQ(sceneFromName("(010)-(101)").blocks.size(), 3U);
  EXPECT_EQ(sceneFromName(SPRINGTOWER_SOURCE_DIR "/scenes/report_t1.toml").blocks.size(), 6U);
  TowerOptions options;
  options.startGap_m = 0.01;
  EXPECT_GT(sceneFromName("tower:2", options).blocks.back().centre.z(), 0.037);
  EXPECT_GT(sceneFromName("(111)-(111)", options).blocks.back().centre.z(), 0.037);
}

TEST(SceneName, ThatIsNoneOfTheseIsNamed) {
  EXPECT_THAT([] { sceneFromName("tower:0"); }, ThrowsMessage<InputError>("tower:0: expected 1 to 2000 rows, got 0"));
  EXPECT_THAT([] { sceneFromName("tower:1000000000"); },
              ThrowsMessage<InputError>("tower:1000000000: expected 1 to 2000 rows, got 1000000000"));
  for (const std::string rows : {"", "ten", "18x", "1.5", " 3", "99999999999999999999"}) {
    EXPECT_THAT([&] { sceneFromName("tower:" + rows); },
                ThrowsMessage<InputError>("tower:R: expected a whole number of rows from 1 to 2000, got '" + rows + "'"));
  }
  EXPECT_THAT([] { sceneFromName("no-such-scene.toml"); },
              ThrowsMessage<InputError>("no-such-scene.toml: expected a scene file, tower:R with R rows, or a bit code such as "
                                        "(010)-(111), got no such file"));
}

TEST(Gravity, PointsStraightDownUnlessTilted) {
  EXPECT_EQ(Gravity{}.at(0.0), Vec3(0.0, 0.0, -9.81));
  EXPECT_EQ(Gravity{}.at(7.0), Vec3(0.0, 0.0, -9.81));
}

TEST(Gravity, LeansByTheTiltTowardsItsDirection) {
  for (const double direction_deg : {0.0, 30.0, 90.0, 225.0}) {
    const Vec3 pull = Gravity{.tilt_deg = 10.0, .direction_deg = direction_deg}.at(0.0);
    EXPECT_NEAR(pull.norm(), 9.81, 1e-14);
    EXPECT_NEAR(std::acos(-pull.z() / 9.81) * 180.0 / std::numbers::pi, 10.0, 1e-9);
    const double angle = direction_deg * std::numbers::pi / 180.0;
    EXPECT_NEAR(pull.x() * std::cos(angle) + pull.y() * std::sin(angle), 9.81 * std::sin(std::numbers::pi / 18.0), 1e-14);
  }
}

TEST(Gravity, SwaysAboutTheTilt) {
  const Gravity gravity{.tilt_deg = 2.0, .sway_deg = 1.5, .sway_hz = 0.5};
  const auto lean_deg = [&](double time_s) {
    const Vec3 pull = gravity.at(time_s);
    return std::atan2(pull.x(), -pull.z()) * 180.0 / std::numbers::pi;
  };
  EXPECT_NEAR(lean_deg(0.0), 2.0, 1e-12);
  EXPECT_NEAR(lean_deg(0.5), 3.5, 1e-12);
  EXPECT_NEAR(lean_deg(1.0), 2.0, 1e-12);
  EXPECT_NEAR(lean_deg(1.5), 0.5, 1e-12);
}

TEST(Tolerance, IsInProportionToTheLowestBlockUnlessGiven) {
  Scene scene = towerScene(2);
  EXPECT_EQ(toleranceOf(scene), kBlockTolerance_m);
  for (BlockSpec& block : scene.blocks) block.dimensions *= 10.0;
  EXPECT_DOUBLE_EQ(toleranceOf(scene), 10.0 * kBlockTolerance_m);
  scene.blocks[3].dimensions.z() = 0.5 * kBlockHeight_m;
  EXPECT_DOUBLE_EQ(toleranceOf(scene), 0.5 * kBlockTolerance_m);
  scene.settings.tolerance_m = 2e-6;
  EXPECT_EQ(toleranceOf(scene), 2e-6);
}

}  // namespace
}  // namespace springtower
