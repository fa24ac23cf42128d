#include "core/scene/friction.h"

#include "core/error.h"
#include "core/scene/remove_block.h"
#include "core/scene/scene.h"
#include "tests/support/program.h"

#include <cmath>
#include <fstream>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <string>

namespace springtower {
namespace {

using ::testing::HasSubstr;

// Reads a text as a scene file in a folder of its own: tests run side by side.
Scene readText(const std::string& text) {
  const ScratchFolder folder;
  const std::string path = folder.file("friction.toml");
  std::ofstream(path) << text;
  return sceneFromToml(path);
}

// Three blocks: one as the scene is, a rough one, one that is smooth against the floor alone.
const std::string kThreeBlocks = R"(
[[block]]
centre_m = [0.0, 0.0, 0.0091]
[[block]]
centre_m = [0.2, 0.0, 0.0091]
friction = 0.9
[[block]]
centre_m = [0.4, 0.0, 0.0091]
static_friction = 0.4
kinetic_friction = 0.1
[floor]
friction = 0.25
[friction]
static = 0.5
kinetic = 0.3
)";

TEST(FrictionTable, SurfacesHaveTheGeometricMeanOfTheirCoefficients) {
  const FrictionTable table(readText(kThreeBlocks));
  EXPECT_EQ(table.of(0, 1), (Friction{std::sqrt(0.5 * 0.9), std::sqrt(0.3 * 0.9)}));
  EXPECT_EQ(table.of(1, 0), table.of(0, 1));
  EXPECT_EQ(table.of(2, -1), (Friction{std::sqrt(0.4 * 0.25), std::sqrt(0.1 * 0.25)}));
  EXPECT_FALSE(table.haveSameSurface(0, 1));
}

TEST(FrictionTable, APairOfItsOwnGoesBeforeSurfaces) {
  const FrictionTable table(readText(kThreeBlocks +
                                     "[[friction_pair]]\na = 1\nb = 0\nfriction = 0.05\n[[friction_pair]]\na = 2\nb = -1\n"
                                     "static_friction = 0.2\nkinetic_friction = 0.0\n"));
  EXPECT_EQ(table.of(0, 1), (Friction{0.05, 0.05}));
  EXPECT_EQ(table.of(-1, 2), (Friction{0.2, 0.0}));
  EXPECT_EQ(table.of(0, -1), (Friction{std::sqrt(0.5 * 0.25), std::sqrt(0.3 * 0.25)}));
}

TEST(FrictionTable, OneCoefficientKeepsItsBits) {
  Scene scene = readText("[[block]]\ncentre_m = [0.0, 0.0, 0.0091]\nfriction = 0.37\n[friction]\ncoefficient = 0.37\n");
  EXPECT_EQ(FrictionTable(scene).of(0, -1), (Friction{0.37, 0.37}));
}

TEST(FrictionTable, MistakesAreNamed) {
  const auto messageOf = [](const std::string& text) {
    try {
      readText(text);
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string("no error");
  };
  const std::string block = "[[block]]\ncentre_m = [0.0, 0.0, 0.0091]\n";
  EXPECT_THAT(messageOf(block + "friction = -0.1\n"), HasSubstr("block[0].friction: expected 0 to 10, got -0.1"));
  EXPECT_THAT(messageOf(block + "friction = 0.1\nstatic_friction = 0.2\n"),
              HasSubstr("expected either friction or static_friction with kinetic_friction, got both"));
  EXPECT_THAT(messageOf(block + "static_friction = 0.2\nkinetic_friction = 0.3\n"),
              HasSubstr("expected 0 to 0.2 (the static one)"));
  EXPECT_THAT(messageOf(block + "[[friction_pair]]\na = 0\nb = 1\nfriction = 0.1\n"),
              HasSubstr("friction_pair[0].b: expected a whole number from -1 to 0, got 1"));
  EXPECT_THAT(messageOf(block + "[[friction_pair]]\na = 0\nb = 0\nfriction = 0.1\n"),
              HasSubstr("expected two blocks, got block 0 twice"));
  EXPECT_THAT(
      messageOf(block + "[[friction_pair]]\na = 0\nb = -1\nfriction = 0.1\n[[friction_pair]]\na = -1\nb = 0\nfriction = 0.1\n"),
      HasSubstr("expected one friction pair of blocks -1 and 0, got two"));
  EXPECT_THAT(messageOf(block + "[[friction_pair]]\na = 0\nb = -1\n"),
              HasSubstr("expected friction or static_friction with kinetic_friction, got neither"));
}

TEST(FrictionTable, PairsFollowTheirBlocksWhenOneIsTakenOut) {
  Scene scene = readText(kThreeBlocks);
  scene.frictionPairs = {{0, 2, {0.2, 0.2}}, {1, -1, {0.1, 0.1}}};
  removeBlock(scene, 1);
  ASSERT_EQ(scene.frictionPairs.size(), 1U);
  EXPECT_EQ(FrictionTable(scene).of(0, 1), (Friction{0.2, 0.2}));
}

}  // namespace
}  // namespace springtower
