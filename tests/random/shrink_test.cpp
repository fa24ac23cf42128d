// Scenes with faults made smaller.
#include "tests/random/shrink.h"

#include "tests/random/judge.h"
#include "tests/random/scene_text.h"
#include "tests/support/program.h"

#include <cmath>
#include <fstream>
#include <gtest/gtest.h>
#include <string>

namespace springtower {
namespace {

Record judgeDivergence(const RandomScene& random) {
  JudgeOptions options;
  options.limit_s = 60.0;
  options.compareThreads = false;
  options.compareSleep = false;
  return judgeScene(random.scene, options);
}

RandomScene fromText(const std::string& text) {
  const ScratchFolder folder;
  std::ofstream(folder.file("scene.toml")) << text;
  RandomScene random;
  random.scene = sceneFromToml(folder.file("scene.toml"));
  return random;
}

void expectSameSurroundings(const Scene& scene, const Scene& other) {
  ASSERT_EQ(scene.drives.size(), other.drives.size());
  for (std::size_t d = 0; d < scene.drives.size(); ++d) {
    EXPECT_EQ(scene.drives[d].block, other.drives[d].block);
    EXPECT_EQ(scene.drives[d].velocity, other.drives[d].velocity);
    EXPECT_EQ(scene.drives[d].spin, other.drives[d].spin);
    EXPECT_EQ(scene.drives[d].amplitude, other.drives[d].amplitude);
    EXPECT_EQ(scene.drives[d].frequency_hz, other.drives[d].frequency_hz);
    EXPECT_EQ(scene.drives[d].start_s, other.drives[d].start_s);
    EXPECT_EQ(scene.drives[d].end_s, other.drives[d].end_s);
  }
  ASSERT_EQ(scene.frictionPairs.size(), other.frictionPairs.size());
  for (std::size_t p = 0; p < scene.frictionPairs.size(); ++p) {
    EXPECT_EQ(scene.frictionPairs[p].a, other.frictionPairs[p].a);
    EXPECT_EQ(scene.frictionPairs[p].b, other.frictionPairs[p].b);
    EXPECT_EQ(scene.frictionPairs[p].friction, other.frictionPairs[p].friction);
  }
  EXPECT_EQ(scene.restitution, other.restitution);
  EXPECT_EQ(scene.floorFriction, other.floorFriction);
}

void expectSameScene(const Scene& scene, const Scene& other) {
  SCOPED_TRACE(scene.name);
  ASSERT_EQ(scene.blocks.size(), other.blocks.size());
  for (std::size_t b = 0; b < scene.blocks.size(); ++b) {
    EXPECT_EQ(scene.blocks[b].centre, other.blocks[b].centre);
    EXPECT_EQ(scene.blocks[b].dimensions, other.blocks[b].dimensions);
    EXPECT_EQ(scene.blocks[b].orientation.coeffs(), other.blocks[b].orientation.coeffs());
    EXPECT_EQ(scene.blocks[b].velocity, other.blocks[b].velocity);
    EXPECT_EQ(scene.blocks[b].spin, other.blocks[b].spin);
    EXPECT_EQ(scene.blocks[b].mass, other.blocks[b].mass);
    EXPECT_EQ(scene.blocks[b].row, other.blocks[b].row);
    EXPECT_EQ(scene.blocks[b].restitution, other.blocks[b].restitution);
    EXPECT_EQ(scene.blocks[b].friction, other.blocks[b].friction);
    EXPECT_EQ(scene.blocks[b].fixed, other.blocks[b].fixed);
  }
  expectSameSurroundings(scene, other);
  ASSERT_EQ(scene.forces.size(), other.forces.size());
  for (std::size_t f = 0; f < scene.forces.size(); ++f) {
    EXPECT_EQ(scene.forces[f].force, other.forces[f].force);
    EXPECT_EQ(scene.forces[f].block, other.forces[f].block);
    EXPECT_EQ(scene.forces[f].corner, other.forces[f].corner);
    EXPECT_EQ(scene.forces[f].end_s, other.forces[f].end_s);
  }
  ASSERT_EQ(scene.moves.size(), other.moves.size());
  for (std::size_t m = 0; m < scene.moves.size(); ++m) {
    EXPECT_EQ(scene.moves[m].kind, other.moves[m].kind);
    EXPECT_EQ(scene.moves[m].towards, other.moves[m].towards);
    EXPECT_EQ(scene.moves[m].drop_m, other.moves[m].drop_m);
    EXPECT_EQ(scene.moves[m].limit_n, other.moves[m].limit_n);
  }
  EXPECT_EQ(scene.floor, other.floor);
  EXPECT_EQ(scene.seconds, other.seconds);
  EXPECT_EQ(scene.staticFriction, other.staticFriction);
  EXPECT_EQ(scene.kineticFriction, other.kineticFriction);
  EXPECT_EQ(scene.gravity.at(0.0), other.gravity.at(0.0));
  EXPECT_EQ(scene.settings.method, other.settings.method);
  EXPECT_EQ(scene.settings.sleep, other.settings.sleep);
  EXPECT_EQ(scene.settings.inertia, other.settings.inertia);
  EXPECT_EQ(scene.settings.tolerance_m, other.settings.tolerance_m);
}

TEST(RandomSceneText, ReadsAsTheSameSceneToTheLastBit) {
  for (std::uint64_t seed = 1; seed <= 300; ++seed) {
    const RandomScene random = randomScene(seed);
    expectSameScene(random.scene, fromText(sceneText(random, "a comment")).scene);
  }
}

TEST(RandomSceneText, KeepsSettingsThatAreNotTheDefault) {
  RandomScene random = randomScene(1);
  random.scene.settings.substeps = 7;
  random.scene.settings.continuousTests = false;
  random.scene.settings.stiffnessDamping = 0.01;
  const Settings read = fromText(sceneText(random, "a comment")).scene.settings;
  EXPECT_EQ(read.substeps, 7);
  EXPECT_FALSE(read.continuousTests);
  EXPECT_EQ(read.stiffnessDamping, 0.01);
}

// The unstable scene with blocks beside it, of which each diverges on its own.
TEST(RandomShrink, LeavesFewerBlocksThatStillDiverge) {
  RandomScene random;
  random.scene = sceneFromToml(SPRINGTOWER_TEST_DATA_DIR "/random/unstable.toml");
  const std::size_t known = random.scene.blocks.size();
  for (int i = 0; i < 3; ++i) {
    BlockSpec beside;
    beside.centre = Vec3(1.0 + i, 2.0, 3.0);
    beside.dimensions = Vec3(0.004, 0.005, 0.006);
    beside.mass = 1e-5;
    random.scene.blocks.push_back(beside);
  }
  const Record record = judgeDivergence(random);
  ASSERT_TRUE(has(record, Fault::diverged));
  const Shrunk shrunk = shrinkScene(random, record, Fault::diverged, judgeDivergence, 60);
  EXPECT_LE(shrunk.judged, 60);
  EXPECT_LT(shrunk.random.scene.blocks.size(), known);
  EXPECT_LT(shrunk.random.scene.seconds, random.scene.seconds);
  // What is written diverges alike.
  const RandomScene read = fromText(sceneText(shrunk.random, "diverged"));
  EXPECT_EQ(judgeDivergence(read).diverged, shrunk.record.diverged);
}

// With a judge that finds the fault wherever the heaviest block is, nothing but that block and round numbers are left.
TEST(RandomShrink, DropsAllThatTheFaultDoesNotNeed) {
  constexpr double kHeavy_kg = 12.345678;
  const auto judge = [](const RandomScene& random) {
    Record record;
    for (const BlockSpec& block : random.scene.blocks) {
      if (std::abs(block.mass - kHeavy_kg) < 1.0) record.diverged = "planted";
    }
    return record;
  };
  std::uint64_t seed = 1;
  while (randomScene(seed).kind != RandomKind::air || randomScene(seed).scene.blocks.size() < 10) ++seed;
  RandomScene random = randomScene(seed);
  random.scene.blocks[5].mass = kHeavy_kg;
  const Shrunk shrunk = shrinkScene(random, judge(random), Fault::diverged, judge, 1000);
  ASSERT_EQ(shrunk.random.scene.blocks.size(), 1U);
  const Scene& scene = shrunk.random.scene;
  EXPECT_EQ(scene.blocks[0].mass, 12.0);
  EXPECT_TRUE(scene.blocks[0].velocity.isZero(0.0));
  EXPECT_EQ(scene.settings.method, Settings{}.method);
  EXPECT_LE(scene.seconds, scene.settings.frame_s * 1.01);
}

TEST(RandomShrink, OfATowerKeepsWhatItsMovesNeed) {
  std::uint64_t seed = 1;
  while (randomScene(seed).scene.moves.empty()) ++seed;
  const RandomScene random = randomScene(seed);
  const auto judge = [](const RandomScene& smaller) {
    Record record;
    if (!smaller.scene.moves.empty()) record.diverged = "planted";
    return record;
  };
  const Shrunk shrunk = shrinkScene(random, judge(random), Fault::diverged, judge, 1000);
  EXPECT_LT(shrunk.random.scene.blocks.size(), random.scene.blocks.size());
  EXPECT_EQ(shrunk.random.scene.moves.size(), 1U);
  EXPECT_NO_THROW(fromText(sceneText(shrunk.random, "a comment")));
}

}  // namespace
}  // namespace springtower
