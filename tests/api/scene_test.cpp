// Scenes and settings as the public headers have them, against those of the engine.
#include "api/convert.h"
#include "scenarios/registry.h"
#include "tests/support/says.h"

#include <array>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <limits>
#include <springtower/inputs.h>
#include <springtower/scene.h>
#include <springtower/world.h>
#include <variant>

namespace springtower::api {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

TEST(ApiScene, CornersHaveToBeFinite) {
  for (const double bad : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(), 1e300}) {
    std::array<Vec3, 8> corners{};
    corners[3].y = bad;
    Block block;
    EXPECT_THAT([&] { placeByCorners(block, corners); },
                ThrowsMessage<InputError>(HasSubstr("placeByCorners: corner 3: expected")));
  }
}

TEST(ApiSettings, HaveTheDefaultsOfTheEngine) {
  EXPECT_EQ(Settings{}, toPublic(springtower::Settings{}));
}

// Every row of the engine's table reaches the public struct and comes back: none has been forgotten.
TEST(ApiSettings, CarryEveryNumberBothWays) {
  for (const springtower::SettingRow& row : springtower::settingTable()) {
    springtower::Settings changed;
    std::visit(
        [&](auto member) {
          using Value = std::decay_t<decltype(changed.*member)>;
          if constexpr (std::is_same_v<Value, bool>) {
            changed.*member = !(changed.*member);
          } else if constexpr (std::is_same_v<Value, int>) {
            changed.*member += 3;
          } else {
            changed.*member = 0.0625;
          }
        },
        row.member);
    const Settings shown = toPublic(changed);
    EXPECT_NE(shown, Settings{}) << row.key;
    EXPECT_EQ(springtower::numberOf(toEngine(shown), row), springtower::numberOf(changed, row)) << row.key;
  }
}

TEST(ApiSettings, EnumerationsAgreeWithTheEngines) {
  for (int number = 0; number <= static_cast<int>(springtower::Method::automatic); ++number) {
    const auto method = static_cast<springtower::Method>(number);
    EXPECT_EQ(toEngine(toPublic(method)), method);
    EXPECT_EQ(nameOf(toPublic(method)), springtower::nameOf(method));
    EXPECT_EQ(methodFromName(springtower::nameOf(method)), toPublic(method));
  }
  for (const auto sleep : {springtower::Sleep::off, springtower::Sleep::on, springtower::Sleep::report}) {
    springtower::Settings settings;
    settings.sleep = sleep;
    EXPECT_EQ(toEngine(toPublic(settings)).sleep, sleep);
  }
  for (const auto inertia : {springtower::Inertia::cuboid, springtower::Inertia::lumped}) {
    springtower::Settings settings;
    settings.inertia = inertia;
    EXPECT_EQ(toEngine(toPublic(settings)).inertia, inertia);
  }
}

TEST(ApiSettings, RefuseWhatIsNotAllowed) {
  Settings settings;
  settings.frame_s = 1.0;
  EXPECT_THAT([&] { checkSettings(settings); }, ThrowsMessage<InputError>(says("settings: frame_s: expected ..., got 1")));
  EXPECT_NO_THROW(checkSettings(Settings{}));
  EXPECT_THAT([] { methodFromName("newmark"); }, ThrowsMessage<InputError>(says("method: expected implicit..., got 'newmark'")));
  EXPECT_THAT([] { static_cast<void>(nameOf(static_cast<Method>(-1))); },
              ThrowsMessage<InputError>(says("method: expected a number from ..., got -1")));
}

void expectTheSame(const Scene& shown, const springtower::Scene& engine) {
  const springtower::Scene back = toEngine(shown);
  EXPECT_EQ(back.name, engine.name);
  EXPECT_EQ(back.seconds, engine.seconds);
  EXPECT_EQ(back.floor, engine.floor);
  EXPECT_EQ(back.plane, engine.plane);
  EXPECT_EQ(back.staticFriction, engine.staticFriction);
  EXPECT_EQ(back.kineticFriction, engine.kineticFriction);
  EXPECT_EQ(back.gravity.at(0.3), engine.gravity.at(0.3));
  ASSERT_EQ(back.blocks.size(), engine.blocks.size());
  for (std::size_t b = 0; b < back.blocks.size(); ++b) {
    EXPECT_EQ(back.blocks[b].centre, engine.blocks[b].centre);
    EXPECT_EQ(back.blocks[b].dimensions, engine.blocks[b].dimensions);
    EXPECT_EQ(back.blocks[b].orientation.coeffs(), engine.blocks[b].orientation.coeffs());
    EXPECT_EQ(back.blocks[b].velocity, engine.blocks[b].velocity);
    EXPECT_EQ(back.blocks[b].spin, engine.blocks[b].spin);
    EXPECT_EQ(back.blocks[b].fixed, engine.blocks[b].fixed);
    EXPECT_EQ(back.blocks[b].mass, engine.blocks[b].mass);
    EXPECT_EQ(back.blocks[b].row, engine.blocks[b].row);
    EXPECT_EQ(back.blocks[b].position, engine.blocks[b].position);
  }
  EXPECT_EQ(back.forces.size(), engine.forces.size());
}

TEST(ApiScene, TowersAreThoseOfTheEngine) {
  const TowerOptions options{.heightsSigma_m = 0.0002,
                             .massSigma_kg = 0.001,
                             .seed = 7,
                             .startGap_m = {},
                             .offsets = {{1, 2, 0.0, 0.001}},
                             .loose = {{0, 3, 0.0004}}};
  springtower::TowerOptions same;
  same.heightsSigma_m = 0.0002;
  same.massSigma_kg = 0.001;
  same.seed = 7;
  same.offsets = {{1, 2, 0.0, 0.001}};
  same.loose = {{0, 3, 0.0004}};
  expectTheSame(towerScene(3, options), springtower::towerScene(3, same));
  expectTheSame(bitCodeScene("(010)-(111)"), springtower::bitCodeScene("(010)-(111)"));
}

TEST(ApiScene, NamesAndFilesAreThoseOfTheEngine) {
  for (const char* name : {"tower:2", "wall:3x2", "thrown", "swaying:2", "(111)-(010)"})
    expectTheSame(namedScene(name), springtower::sceneNamed(name));
  for (const char* name : {"two_thrown_blocks", "report_t1", "thin_wall"}) {
    const std::string path = std::string(SPRINGTOWER_SOURCE_DIR "/scenes/") + name + ".toml";
    expectTheSame(sceneFromToml(path), springtower::sceneFromToml(path));
  }
  ASSERT_EQ(scenarioList().size(), springtower::scenarios().size());
  EXPECT_THAT(scenarioList().front().usage, HasSubstr("tower:"));
}

TEST(ApiScene, FixesAndDrivesBlocks) {
  Scene scene;
  scene.blocks.resize(3);
  scene.blocks[0].fixed = true;
  scene.blocks[1].centre = {0.0, 0.0, 0.3};
  scene.blocks[2].centre = {0.0, 0.0, 0.5};
  scene.drives = {{.block = 1,
                   .velocity_m_s = {1.0, 2.0, 3.0},
                   .spin_rad_s = {4.0, 5.0, 6.0},
                   .amplitude_m = {0.1, 0.2, 0.3},
                   .frequency_hz = 7.0,
                   .start_s = 8.0,
                   .end_s = 9.0}};
  EXPECT_NO_THROW(checkScene(scene));
  const Scene back = toPublic(toEngine(scene));
  EXPECT_TRUE(back.blocks[0].fixed);
  EXPECT_TRUE(back.blocks[1].fixed) << "it is driven";
  EXPECT_FALSE(back.blocks[2].fixed);
  ASSERT_EQ(back.drives.size(), 1U);
  EXPECT_EQ(back.drives[0].velocity_m_s, scene.drives[0].velocity_m_s);
  EXPECT_EQ(back.drives[0].spin_rad_s, scene.drives[0].spin_rad_s);
  EXPECT_EQ(back.drives[0].amplitude_m, scene.drives[0].amplitude_m);
  EXPECT_EQ(back.drives[0].frequency_hz, 7.0);
  EXPECT_EQ(back.drives[0].end_s, 9.0);
  World world(scene);
  EXPECT_THAT([&] { grab(world, 0, 5.0); },
              ThrowsMessage<InputError>(says("grab: block: expected a block that moves, got block 0, which is fixed")));
  EXPECT_THAT([&] { kick(world, 1, {}); },
              ThrowsMessage<InputError>(says("kick: block: expected a block that moves, got block 1, which is fixed")));
  EXPECT_THAT([&] { pushThroughFrame(world, 0, {}); },
              ThrowsMessage<InputError>(says("force: block: expected ..., got block 0, which is")));
}

TEST(ApiScene, RefusesWhatIsNotAllowed) {
  EXPECT_THAT([] { towerScene(0); }, ThrowsMessage<InputError>(HasSubstr("expected 1 to 2000 rows, got 0")));
  EXPECT_THAT([] { bitCodeScene("(01"); }, ThrowsMessage<InputError>(HasSubstr("(01")));
  EXPECT_THAT([] { namedScene("no-such-scene"); },
              ThrowsMessage<InputError>(says("'no-such-scene': expected ..., got none of them")));
  EXPECT_THAT([] { sceneFromToml("no/such/file.toml"); }, ThrowsMessage<InputError>(HasSubstr("no/such/file.toml")));
  EXPECT_THAT([] { sceneFromToml(SPRINGTOWER_SOURCE_DIR "/scenes/moves.toml"); },
              ThrowsMessage<InputError>(says("expected a scene without moves, got ... moves of a scripted hand")));
  Scene scene = towerScene(2);
  EXPECT_NO_THROW(checkScene(scene));
  scene.blocks[4].centre.z -= 0.001;
  EXPECT_THAT([&] { checkScene(scene); }, ThrowsMessage<InputError>(HasSubstr("mm inside each other")));
}

}  // namespace
}  // namespace springtower::api
