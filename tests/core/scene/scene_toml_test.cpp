#include "core/error.h"
#include "core/scene/scene.h"
#include "tests/support/program.h"
#include "tests/support/says.h"

#include <algorithm>
#include <filesystem>
#include <fmt/format.h>
#include <fstream>
#include <gmock/gmock.h>
#include <numbers>
#include <string>
#include <vector>

namespace springtower {
namespace {

using testing::ThrowsMessage;

const std::string kData = SPRINGTOWER_TEST_DATA_DIR "/scenes/";
const std::string kScenes = SPRINGTOWER_SOURCE_DIR "/scenes/";

// Reads a text as a scene file in a folder of its own: tests run side by side.
Scene fromText(const std::string& text) {
  const ScratchFolder folder;
  const std::string path = folder.file("scene.toml");
  std::ofstream(path) << text;
  return sceneFromToml(path);
}

TEST(SceneFile, SetsEverythingASceneHas) {
  const Scene scene = sceneFromToml(kData + "everything.toml");
  EXPECT_EQ(scene.name, "everything");
  EXPECT_EQ(scene.seconds, 2.5);
  ASSERT_EQ(scene.blocks.size(), 7U);
  EXPECT_FALSE(scene.floor);
  EXPECT_EQ(scene.staticFriction, 0.5);
  EXPECT_EQ(scene.kineticFriction, 0.3);
  EXPECT_EQ(scene.gravity.magnitude, 1.62);
  EXPECT_EQ(scene.gravity.tilt_deg, 3.0);
  EXPECT_EQ(scene.gravity.direction_deg, 45.0);
  EXPECT_EQ(scene.gravity.sway_deg, 0.5);
  EXPECT_EQ(scene.gravity.sway_hz, 2.0);
  EXPECT_EQ(scene.settings.method, Method::rungeKutta4);
  EXPECT_EQ(scene.settings.inertia, Inertia::lumped);
  EXPECT_EQ(scene.settings.sleep, Sleep::report);
  EXPECT_EQ(scene.settings.substeps, 120);
  EXPECT_FALSE(scene.settings.continuousTests);
  EXPECT_FALSE(scene.settings.tolerance_m);
  EXPECT_EQ(scene.settings.stabilitySafety, Settings{}.stabilitySafety);

  const BlockSpec& block = scene.blocks[6];
  EXPECT_EQ(block.row, -1);
  EXPECT_EQ(block.centre, Vec3(0.3, 0.1, 0.5));
  EXPECT_EQ(block.dimensions, Vec3(0.1, 0.04, 0.02));
  EXPECT_EQ(block.mass, 0.05);
  EXPECT_EQ(block.velocity, Vec3(1, -2, 3));
  EXPECT_EQ(block.spin, Vec3(4, 5, -6));
  EXPECT_LT((block.orientation * Vec3::UnitX() - Vec3::UnitY()).norm(), 1e-15);

  ASSERT_EQ(scene.forces.size(), 2U);
  EXPECT_EQ(scene.forces[0].block, 5);
  EXPECT_EQ(scene.forces[0].corner, 5);
  EXPECT_EQ(scene.forces[0].force, Vec3(0.1, 0.2, -0.3));
  EXPECT_EQ(scene.forces[0].start_s, 0.5);
  EXPECT_EQ(scene.forces[0].end_s, 1.5);
  EXPECT_EQ(scene.forces[1].block, 6);
  EXPECT_EQ(scene.forces[1].corner, -1);
  EXPECT_EQ(scene.forces[1].start_s, 0.0);
}

TEST(SceneFile, DescribesTheTowerThatItsOptionsDescribe) {
  TowerOptions options;
  options.heightsSigma_m = 0.0002;
  options.massSigma_kg = 0.001;
  options.seed = 7;
  options.startGap_m = 0.001;
  options.offsets = {{1, 2, 0.003, -0.004}};
  options.loose = {{0, 2, 0.0005}};
  const Scene expected = bitCodeScene("(111)-(010)-(10L)", options);
  const Scene scene = sceneFromToml(kData + "everything.toml");
  for (std::size_t b = 0; b < expected.blocks.size(); ++b) {
    EXPECT_EQ(scene.blocks[b].centre, expected.blocks[b].centre);
    EXPECT_EQ(scene.blocks[b].dimensions, expected.blocks[b].dimensions);
    EXPECT_EQ(scene.blocks[b].mass, expected.blocks[b].mass);
    EXPECT_EQ(scene.blocks[b].row, expected.blocks[b].row);
    EXPECT_EQ(scene.blocks[b].position, expected.blocks[b].position);
  }
}

TEST(SceneFile, HasTheDefaultsOfASceneWhereItIsSilent) {
  const Scene scene = fromText("[tower]\nrows = 3\n");
  const Scene tower = towerScene(3);
  EXPECT_EQ(scene.blocks.size(), tower.blocks.size());
  EXPECT_EQ(scene.seconds, tower.seconds);
  EXPECT_EQ(scene.plane, tower.plane);
  EXPECT_EQ(scene.staticFriction, tower.staticFriction);
  EXPECT_EQ(scene.gravity.magnitude, tower.gravity.magnitude);
  EXPECT_TRUE(scene.floor);
  EXPECT_THAT(scene.name, testing::HasSubstr("scene.toml"));
}

TEST(SceneFile, RotationIsAnAxisTimesItsAngle) {
  const Scene scene = fromText("[[block]]\ncentre_m = [0, 0, 1]\nrotation_deg = [0.0, 30.0, 40.0]\n");
  const Eigen::AngleAxisd rotation(scene.blocks[0].orientation);
  EXPECT_NEAR(rotation.angle() * 180.0 / std::numbers::pi, 50.0, 1e-12);
  EXPECT_LT((rotation.axis() - Vec3(0.0, 0.6, 0.8)).norm(), 1e-14);
}

TEST(SceneFile, ReadsEverySettingOfTheTable) {
  for (const SettingRow& row : settingTable()) {
    std::string most = fmt::format("{}", row.most);
    if (std::holds_alternative<bool Settings::*>(row.member)) most = "true";
    const Settings settings = fromText(fmt::format("[tower]\nrows = 1\n[settings]\n{} = {}\n", row.key, most)).settings;
    EXPECT_EQ(numberOf(settings, row), row.most) << row.key;
    EXPECT_EQ(settings.tolerance_m.has_value(), row.key == "tolerance_m") << row.key;
  }
  EXPECT_FALSE(fromText("[tower]\nrows = 1\n[settings]\ncontinuous_tests = false\n").settings.continuousTests);
}

const SettingRow& rowOf(std::string_view key) {
  const auto rows = settingTable();
  return *std::find_if(rows.begin(), rows.end(), [&](const SettingRow& row) { return row.key == key; });
}

std::string asToml(const SettingRow& row, double value) {
  return std::holds_alternative<bool Settings::*>(row.member) ? (value == 0.0 ? "false" : "true") : fmt::format("{}", value);
}

TEST(SceneFile, ReadsEveryFormerKeyAsTheKeyOfToday) {
  for (const SettingAlias& alias : settingAliases()) {
    const SettingRow& row = rowOf(alias.key);
    ASSERT_NE(numberOf(Settings{}, row), row.most) << row.key << " would read as its default";
    const std::string text = fmt::format("[tower]\nrows = 1\n[settings]\n{} = {}\n", alias.formerKey, asToml(row, row.most));
    EXPECT_EQ(numberOf(fromText(text).settings, row), row.most) << alias.formerKey;
  }
}

TEST(SceneFile, ReadsMethodsByTheNamesOfTheField) {
  EXPECT_EQ(fromText("[tower]\nrows = 1\n[settings]\nmethod = \"legacy-2003\"\n").settings.method, Method::report);
}

TEST(SceneFile, GivesWayToOptionsOfTheCommandLine) {
  TowerOptions options;
  options.seed = 8;
  options.startGap_m = 0.0;
  TowerOptions expected = options;
  expected.heightsSigma_m = 0.0002;
  expected.massSigma_kg = 0.001;
  expected.offsets = {{1, 2, 0.003, -0.004}};
  expected.loose = {{0, 2, 0.0005}};
  const Scene scene = sceneFromName(kData + "everything.toml", options);
  const Scene tower = bitCodeScene("(111)-(010)-(10L)", expected);
  for (std::size_t b = 0; b < tower.blocks.size(); ++b) {
    EXPECT_EQ(scene.blocks[b].centre, tower.blocks[b].centre);
    EXPECT_EQ(scene.blocks[b].mass, tower.blocks[b].mass);
  }
}

TEST(SceneFile, WithoutATowerRefusesTheOptionsOfOne) {
  const std::string path = kScenes + "dropped_block.toml";
  const auto with = [&](auto change) {
    TowerOptions options;
    change(options);
    return [path, options] { sceneFromName(path, options); };
  };
  const std::string rest = ", got a scene without";
  EXPECT_THAT(with([](TowerOptions& o) { o.heightsSigma_m = 0.0002; }),
              ThrowsMessage<InputError>(path + ": expected a [tower] for a variation of heights" + rest));
  EXPECT_THAT(with([](TowerOptions& o) { o.massSigma_kg = 0.001; }),
              ThrowsMessage<InputError>(path + ": expected a [tower] for a variation of masses" + rest));
  EXPECT_THAT(with([](TowerOptions& o) { o.seed = 1; }),
              ThrowsMessage<InputError>(path + ": expected a [tower] for a seed" + rest));
  EXPECT_THAT(with([](TowerOptions& o) { o.startGap_m = 0.01; }),
              ThrowsMessage<InputError>(path + ": expected a [tower] for a start gap" + rest));
  EXPECT_NO_THROW(sceneFromName(path));
}

// One line each: file, line and column, key, what is expected, what it got.
TEST(BadSceneFile, IsNamedInOneLine) {
  const std::pair<const char*, const char*> cases[] = {
      {"unknown_key",
       ":3:1: expected centre_m, dimensions_m, mass_kg, rotation_deg, velocity_m_s, "
       "spin_rad_s, restitution, fixed, friction, static_friction, kinetic_friction, corners_m in block[0], got the unknown key "
       "'colour'"},
      {"wrong_type", ":1:11: seconds: expected a number from 0.001 to 10000000 s, got the text 'ten'"},
      {"wrong_whole_number", ":2:8: tower.rows: expected a whole number from 1 to 2000, got 3.5"},
      {"wrong_array", ":2:12: block[0].centre_m: expected an array of three numbers from -10000 to 10000 m, got an array of 2"},
      {"wrong_array_value", ":2:18: block[0].centre_m[1]: expected a number from -10000 to 10000 m, got true"},
      {"not_an_array_of_tables", ":1:1: block: expected up to 200000 tables, each [[block]], got a table"},
      {"not_a_table", ":1:9: tower: expected a table, [tower], got 18"},
      {"negative_mass", ":6:11: block[1].mass_kg: expected 1e-09 to 1000000 kg, got -0.0196"},
      {"not_a_number", ":3:22: block[0].velocity_m_s[1]: expected -1000 to 1000 m/s, got nan"},
      {"infinite", ":1:11: seconds: expected 0.001 to 10000000 s, got inf"},
      {"absurd_size", ":3:32: block[0].dimensions_m[2]: expected 1e-05 to 100 m, got 1000"},
      {"absurd_rows", ":2:8: tower.rows: expected a whole number from 1 to 2000, got 1000000000"},
      {"zero_thickness", ":3:32: block[0].dimensions_m[2]: expected 1e-05 to 100 m, got 0"},
      {"code_typo", ":1:1: tower: bit code '(010)-(0120)': character 10: expected 0, 1 or L, got '2'"},
      {"absent_offset",
       ":1:1: tower: (010)-(010): offset of row 1, position 3: expected rows 0 to 1 and positions 1 to 3 where a block is "
       "present, got no block there"},
      {"rows_and_code", ":1:1: tower: expected either rows or code, got both or neither"},
      {"no_blocks", ": expected a [tower], [[block]]s or both, got no blocks"},
      {"no_centre", ":1:1: block[0]: expected the key centre_m, got none"},
      {"inside_each_other", ": block 0 and block 1: expected a start up to 0.2 mm inside each other, as at rest, got 1 mm"},
      {"inside_the_floor", ": block 0: expected a start up to 0.2 mm inside the floor z = 0, as at rest, got 1 mm"},
      {"unknown_method",
       ":5:10: settings.method: expected implicit (also: bdf2), implicit-euler, implicit-eigen (also: bdf2-eigen), "
       "semi-implicit-euler, midpoint, runge-kutta-4, report (also: legacy-2003), rigid-pgs, rigid-lcp, xpbd or auto, got "
       "'euler'"},
      {"setting_out_of_range", ":5:20: settings.stability_safety: expected 0.05 to 1, got 1.5"},
      {"force_on_no_block", ":5:9: force[0].block: expected a whole number from 0 to 0, got 1"},
      {"force_ends_first", ":8:9: force[0].end_s: expected 2 to 10000000 s, got 1"},
      {"friction_twice", ":4:1: friction: expected either coefficient or static with kinetic, got both or neither"},
      {"kinetic_above_static", ":6:11: friction.kinetic: expected 0 to 0.4 (the static one), got 0.5"},
  };
  for (const auto& [name, message] : cases) {
    const std::string path = kData + name + ".toml";
    EXPECT_THAT([&] { sceneFromToml(path); }, ThrowsMessage<InputError>(path + message));
  }
}

TEST(SceneFile, FixesAndDrivesBlocks) {
  const std::string blocks =
      "[[block]]\ncentre_m = [0, 0, -0.1]\nfixed = true\n"  // in the floor
      "[[block]]\ncentre_m = [0, 0, 0.3]\n[[block]]\ncentre_m = [0, 0, 0.5]\n";
  const Scene scene = fromText(blocks +
                               "[[drive]]\nblock = 1\nvelocity_m_s = [1, 2, 3]\nspin_rad_s = [4, 5, 6]\nend_s = 2\n"
                               "[[drive]]\nblock = 0\namplitude_m = [0.1, 0.2, 0.3]\nfrequency_hz = 7\nstart_s = 1\n");
  EXPECT_TRUE(scene.blocks[0].fixed);
  EXPECT_TRUE(scene.blocks[1].fixed) << "it is driven";
  EXPECT_FALSE(scene.blocks[2].fixed);
  ASSERT_EQ(scene.drives.size(), 2U);
  EXPECT_EQ(scene.drives[0].velocity, Vec3(1.0, 2.0, 3.0));
  EXPECT_EQ(scene.drives[0].spin, Vec3(4.0, 5.0, 6.0));
  EXPECT_EQ(scene.drives[0].end_s, 2.0);
  EXPECT_EQ(scene.drives[1].block, 0);
  EXPECT_EQ(scene.drives[1].amplitude, Vec3(0.1, 0.2, 0.3));
  EXPECT_EQ(scene.drives[1].frequency_hz, 7.0);
  EXPECT_EQ(scene.drives[1].start_s, 1.0);
  EXPECT_EQ(scene.drives[1].end_s, kTimeRange.most);
  EXPECT_THAT(
      [&] { fromText(blocks + "[[drive]]\nblock = 3\n"); },
      testing::ThrowsMessage<InputError>(testing::HasSubstr("drive[0].block: expected a whole number from 0 to 2, got 3")));
  EXPECT_THAT([&] { fromText(blocks + "[[force]]\nblock = 0\nforce_n = [1, 0, 0]\nend_s = 1\n"); },
              testing::ThrowsMessage<InputError>(
                  testing::HasSubstr("force 0: block: expected a block that moves, got block 0, which is fixed")));
}

// toml++ has no double for them, and what it gave instead was read all the same.
TEST(BadSceneFile, WholeNumbersThatNoDoubleIsAreNumbersOutOfRange) {
  for (const std::string number : {"9007199254740993", "15027880428509895", "-9223372036854775807"}) {
    EXPECT_THAT([&] { fromText("[[block]]\ncentre_m = [0, 0, 1]\nrotation_deg = [0, " + number + ", 0]\n"); },
                testing::ThrowsMessage<InputError>(says("rotation_deg[1]: expected -360 to 360..., got " + number)))
        << number;
  }
}

TEST(BadSceneFile, UnknownSettingListsTheKnownOnes) {
  const std::string path = kData + "unknown_setting.toml";
  std::string known = "method, inertia, sleep";
  for (const SettingRow& row : settingTable()) known += fmt::format(", {}", row.key);
  EXPECT_THAT([&] { sceneFromToml(path); },
              ThrowsMessage<InputError>(path + ":5:1: expected " + known + " in settings, got the unknown key 'sub_steps'"));
}

TEST(BadSceneFile, BothNamesOfOneSettingAreRefused) {
  for (const SettingAlias& alias : settingAliases()) {
    const std::string value = asToml(rowOf(alias.key), rowOf(alias.key).most);
    const std::string text =
        fmt::format("[tower]\nrows = 1\n[settings]\n{0} = {2}\n{1} = {2}\n", alias.formerKey, alias.key, value);
    const std::string message = fmt::format(":5:{0}: settings.{1}: expected {1} or its former name {2}, got both",
                                            alias.key.size() + 4, alias.key, alias.formerKey);
    EXPECT_THAT([&] { fromText(text); }, testing::ThrowsMessage<InputError>(testing::EndsWith(message)));
  }
}

TEST(BadSceneFile, AFormerKeyIsNamedAsItIsGiven) {
  EXPECT_THAT(
      [] { fromText("[tower]\nrows = 1\n[settings]\nrest_speed = -1.0\n"); },
      testing::ThrowsMessage<InputError>(testing::EndsWith(":4:14: settings.rest_speed: expected 0 to 1 sqrt(g h), got -1")));
}

TEST(BadSceneFile, BrokenTomlIsNamedByLineAndColumn) {
  const std::string path = kData + "broken.toml";
  try {
    sceneFromToml(path);
    FAIL() << "a broken file was read";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), testing::StartsWith(path + ":2:"));
    EXPECT_THAT(error.what(), testing::Not(testing::HasSubstr("\n")));
  }
}

TEST(BadSceneFile, MissingFilesAndFoldersAreNamed) {
  EXPECT_THAT([] { sceneFromToml("no/such/scene.toml"); },
              ThrowsMessage<InputError>("no/such/scene.toml: expected a scene file, tower:R with R rows, or a bit code such as "
                                        "(010)-(111), got no such file"));
  EXPECT_THAT([] { sceneFromToml(SPRINGTOWER_SOURCE_DIR "/scenes"); },
              ThrowsMessage<InputError>(SPRINGTOWER_SOURCE_DIR "/scenes: expected a scene file, got a folder"));
  EXPECT_THAT([] { sceneFromToml("no\nsuch"); },
              ThrowsMessage<InputError>(
                  testing::AllOf(testing::StartsWith("no\\x0asuch: expected "), testing::EndsWith(", got no such file"))));
}

TEST(ExampleScenes, AllLoad) {
  int count = 0;
  for (const auto& entry : std::filesystem::directory_iterator(kScenes)) {
    EXPECT_NO_THROW(sceneFromToml(entry.path().string())) << entry.path();
    ++count;
  }
  EXPECT_GE(count, 12);
}

struct ShownKey {
  std::string value;
  std::string comment;
};

// A line "key = value  # comment" of the annotated example; the key may be commented out.
ShownKey shownIn(const std::vector<std::string>& lines, std::string_view key) {
  const std::string start = fmt::format("{} = ", key);
  for (const std::string& line : lines) {
    const std::string shown = line.starts_with("# ") ? line.substr(2) : line;
    if (!shown.starts_with(start)) continue;
    const std::size_t comment = shown.find(" # ");
    if (comment == std::string::npos) return {shown.substr(start.size()), ""};
    return {shown.substr(start.size(), comment - start.size()), shown.substr(comment + 3)};
  }
  return {};
}

std::vector<std::string> linesOf(const std::string& path) {
  std::ifstream stream(path);
  std::vector<std::string> lines;
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

// The annotated example is the reference for users: it must show every setting, with the default that is in force.
TEST(ExampleScenes, AnnotatedOneShowsEverySettingWithItsDefault) {
  const std::vector<std::string> lines = linesOf(kScenes + "annotated.toml");
  for (const SettingRow& row : settingTable()) {
    const ShownKey shown = shownIn(lines, row.key);
    ASSERT_FALSE(shown.value.empty()) << row.key;
    const bool isFlag = std::holds_alternative<bool Settings::*>(row.member);
    const double value = isFlag ? (shown.value.starts_with("true") ? 1.0 : 0.0) : std::stod(shown.value);
    EXPECT_EQ(value, numberOf(Settings{}, row).value_or(kBlockTolerance_m)) << row.key;
    const std::string unit = row.unit.empty() ? "" : std::string(row.unit) + ",";
    EXPECT_THAT(shown.comment, testing::StartsWith(unit)) << row.key;
    EXPECT_FALSE(shown.comment.empty()) << row.key;
  }
}

TEST(ExampleScenes, AnnotatedOneIsTheDefaultTowerAndABlock) {
  const Scene scene = sceneFromToml(kScenes + "annotated.toml");
  const Scene tower = towerScene(18);
  ASSERT_EQ(scene.blocks.size(), 55U);
  for (std::size_t b = 0; b < 54; ++b) {
    EXPECT_EQ(scene.blocks[b].centre, tower.blocks[b].centre);
    EXPECT_EQ(scene.blocks[b].dimensions, tower.blocks[b].dimensions);
    EXPECT_EQ(scene.blocks[b].mass, tower.blocks[b].mass);
  }
  const BlockSpec standard;
  EXPECT_EQ(scene.blocks[54].dimensions, standard.dimensions);
  EXPECT_EQ(scene.blocks[54].mass, standard.mass);
  EXPECT_EQ(scene.seconds, tower.seconds);
  EXPECT_EQ(scene.staticFriction, tower.staticFriction);
  EXPECT_EQ(scene.kineticFriction, tower.kineticFriction);
  EXPECT_EQ(scene.gravity.magnitude, tower.gravity.magnitude);
  EXPECT_EQ(scene.gravity.tilt_deg, tower.gravity.tilt_deg);
  EXPECT_EQ(scene.settings.method, Settings{}.method);
  EXPECT_EQ(scene.settings.inertia, Settings{}.inertia);
  EXPECT_EQ(scene.settings.sleep, Settings{}.sleep);
}

TEST(ExampleScenes, KeysThatAreCommentedOutAreKeysThatAreAllowed) {
  std::string text;
  for (const std::string& line : linesOf(kScenes + "annotated.toml")) {
    const std::string bare = line.starts_with("# ") ? line.substr(2) : line;
    const bool opensTable = bare.starts_with("[[");
    // Keys that contradict one that is shown stay commented out.
    const bool isKey = bare.find(" = ") == bare.find(' ') && bare.find(' ') != std::string::npos && !bare.starts_with("code") &&
                       !bare.starts_with("block") && !bare.starts_with("static") && !bare.starts_with("kinetic") &&
                       !bare.starts_with("point_m") && !bare.starts_with("corners_m");
    text += (opensTable || isKey ? bare : line) + "\n";
  }
  const Scene scene = fromText(text);
  ASSERT_EQ(scene.forces.size(), 1U);
  EXPECT_EQ(scene.forces[0].block, 52);
  EXPECT_NEAR(scene.blocks[27].dimensions.z(), 0.0179, 1e-17);
  EXPECT_EQ(scene.settings.tolerance_m, kBlockTolerance_m);
}

}  // namespace
}  // namespace springtower
