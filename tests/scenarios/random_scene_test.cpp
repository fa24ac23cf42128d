// Scenes drawn at random: what they keep to, and that a seed is one scene for ever.
#include "scenarios/random_scene.h"

#include "core/hash.h"
#include "core/limits.h"
#include "scenarios/random_draw.h"
#include "scenarios/random_fixtures.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <gtest/gtest.h>
#include <set>
#include <string>

namespace springtower {
namespace {

constexpr std::uint64_t kFirst = 1000;  // as the target random_3000 begins
constexpr std::uint64_t kSeeds = 300;

// Numbers to a billionth: orientations come from sines and cosines, whose last bits differ between mathematical libraries.
void add(Hash& hash, double value) {
  hash.word(static_cast<std::uint64_t>(std::llround(value * 1e9)));
}
void add(Hash& hash, const Vec3& value) {
  for (const double component : value) add(hash, component);
}

std::uint64_t hashOf(const Scene& scene) {
  Hash hash;
  for (const BlockSpec& block : scene.blocks) {
    add(hash, block.centre);
    add(hash, block.dimensions);
    add(hash, block.orientation.vec());
    add(hash, block.velocity);
    add(hash, block.spin);
    add(hash, block.mass);
    add(hash, block.restitution.value_or(-1.0));
    add(hash, block.friction ? block.friction->kineticFriction : -1.0);
    hash.word(block.fixed ? 1 : 0);
  }
  for (const UserForce& force : scene.forces) add(hash, force.force);
  for (const Move& move : scene.moves) add(hash, move.speed_m_s);
  for (const Drive& drive : scene.drives) add(hash, Vec3(drive.velocity + drive.spin + drive.amplitude));
  for (const FrictionPair& pair : scene.frictionPairs) add(hash, pair.friction.staticFriction);
  add(hash, scene.floorFriction ? scene.floorFriction->staticFriction : -1.0);
  add(hash, scene.restitution);
  add(hash, scene.gravity.magnitude);
  add(hash, scene.gravity.tilt_deg);
  add(hash, scene.staticFriction);
  add(hash, scene.kineticFriction);
  add(hash, scene.settings.tolerance_m.value_or(0.0));
  add(hash, scene.seconds);
  hash.word(static_cast<std::uint64_t>(scene.settings.method));
  return hash.value();
}

TEST(RandomScene, OfASeedIsTheSameForEver) {
  Hash all;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) all.word(hashOf(randomScene(seed).scene));
  EXPECT_EQ(all.value(), 12297321417156638025U) << "seeds in reports and files mean other scenes now";
}

TEST(RandomScene, OfTwoCallsIsTheSameToTheLastBit) {
  for (std::uint64_t seed = kFirst; seed < kFirst + kSeeds; ++seed) {
    const Scene one = randomScene(seed).scene;
    const Scene other = randomScene(seed).scene;
    ASSERT_EQ(one.blocks.size(), other.blocks.size()) << seed;
    for (std::size_t b = 0; b < one.blocks.size(); ++b) {
      EXPECT_EQ(one.blocks[b].centre, other.blocks[b].centre) << seed;
      EXPECT_EQ(one.blocks[b].orientation.coeffs(), other.blocks[b].orientation.coeffs()) << seed;
    }
  }
}

TEST(RandomScene, OfEverySeedPassesTheCheckOfScenes) {
  for (std::uint64_t seed = kFirst; seed < kFirst + 10 * kSeeds; ++seed) {
    const Scene scene = randomScene(seed).scene;
    EXPECT_NO_THROW(checkScene(scene, scene.name));
  }
}

TEST(RandomScene, KeepsItsRanges) {
  for (std::uint64_t seed = kFirst; seed < kFirst + 10 * kSeeds; ++seed) {
    const RandomScene random = randomScene(seed);
    const Scene& scene = random.scene;
    SCOPED_TRACE(scene.name);
    EXPECT_TRUE(isInside(static_cast<double>(scene.blocks.size()), {kMinRandomBlocks, kMaxRandomBlocks, ""}));
    for (const BlockSpec& block : scene.blocks) {
      EXPECT_TRUE(isInside(block.dimensions.minCoeff(), {kMinRandomSide_m, kMaxRandomSide_m, "m"})) << block.dimensions;
      EXPECT_LE(block.dimensions.maxCoeff(), kMaxRandomSide_m);
      EXPECT_LE(block.velocity.norm(), kMaxRandomSpeed_m_s);
      if (block.friction) {
        EXPECT_LE(block.friction->staticFriction, kMaxRandomFriction);
      }
    }
    EXPECT_TRUE(isInside(scene.restitution, kRestitutionRange));
    for (const Drive& drive : scene.drives) {
      EXPECT_LE(drive.velocity.norm(), kMaxDriveSpeed_m_s * (1.0 + 1e-12));
      EXPECT_LE(drive.spin.norm(), kMaxDriveSpin_rad_s * (1.0 + 1e-12));
      if (scene.floor) {
        EXPECT_GE(drive.velocity.z(), 0.0);
        EXPECT_EQ(drive.amplitude.z(), 0.0);
      }
    }
    EXPECT_LE(massRatioOf(scene), kMaxRandomMassRatio);
    EXPECT_TRUE(isInside(scene.staticFriction, {0.0, kMaxRandomFriction, ""}));
    EXPECT_LE(scene.kineticFriction, scene.staticFriction);
    EXPECT_TRUE(isInside(scene.gravity.magnitude, {0.0, kMaxRandomGravity_m_s2, ""}));
    if (scene.settings.tolerance_m) {
      EXPECT_TRUE(isInside(*scene.settings.tolerance_m, {kMinRandomTolerance_m, kMaxRandomTolerance_m, "m"}));
    }
    EXPECT_LE(toleranceOf(scene), kMaxRandomToleranceShare * blockHeightOf(scene));
    EXPECT_LE(scene.seconds, scene.moves.empty() ? kMaxRandomSeconds : kMaxRandomMoveSeconds);
  }
}

TEST(RandomScene, IsOfEveryKindAndMethodAmongThreeHundred) {
  std::set<std::string_view> kinds;
  std::set<std::string_view> methods;
  std::set<int> ratios;
  int moves = 0;
  int forces = 0;
  int twoFrictions = 0;
  for (std::uint64_t seed = kFirst; seed < kFirst + kSeeds; ++seed) {
    const RandomScene random = randomScene(seed);
    kinds.insert(nameOf(random.kind));
    methods.insert(nameOf(random.scene.settings.method));
    ratios.insert(static_cast<int>(std::ceil(std::log10(massRatioOf(random.scene)) - 1e-9)));
    moves += random.scene.moves.empty() ? 0 : 1;
    forces += random.scene.forces.empty() ? 0 : 1;
    twoFrictions += random.scene.kineticFriction < random.scene.staticFriction ? 1 : 0;
  }
  EXPECT_EQ(kinds.size(), kRandomKinds.size());
  EXPECT_EQ(methods.size(), 11U);  // all of core/settings.h
  EXPECT_EQ(ratios, (std::set{0, 1, 2, 3, 4}));
  EXPECT_GT(moves, 0);
  EXPECT_GT(forces, 0);
  EXPECT_GT(twoFrictions, 0);
}

TEST(RandomScene, HasSurfacesAndFixedAndDrivenBlocksInSome) {
  int restitutions = 0;
  int ownRestitutions = 0;
  int ownFrictions = 0;
  int floors = 0;
  int pairs = 0;
  int fixed = 0;
  std::array<int, 3> driven{};
  for (std::uint64_t seed = kFirst; seed < kFirst + kSeeds; ++seed) {
    const Scene scene = randomScene(seed).scene;
    const auto count = [&](const auto& has) { return std::any_of(scene.blocks.begin(), scene.blocks.end(), has) ? 1 : 0; };
    restitutions += scene.restitution != kWoodRestitution ? 1 : 0;
    ownRestitutions += count([](const BlockSpec& block) { return block.restitution.has_value(); });
    ownFrictions += count([](const BlockSpec& block) { return block.friction.has_value(); });
    floors += scene.floorFriction ? 1 : 0;
    pairs += scene.frictionPairs.empty() ? 0 : 1;
    fixed += count([](const BlockSpec& block) { return block.fixed; });
    for (const Drive& drive : scene.drives) {
      driven[0] += drive.velocity.isZero(0.0) ? 0 : 1;
      driven[1] += drive.spin.isZero(0.0) ? 0 : 1;
      driven[2] += drive.amplitude.isZero(0.0) ? 0 : 1;
    }
  }
  EXPECT_GT(restitutions, 100);
  for (const int some : {ownRestitutions, ownFrictions, floors, pairs}) EXPECT_GT(some, 10);
  EXPECT_GT(fixed, 50);
  for (const int some : driven) EXPECT_GT(some, 3);
}

TEST(RandomScene, InSpaceHasNeitherFloorNorGravity) {
  for (std::uint64_t seed = kFirst; seed < kFirst + kSeeds; ++seed) {
    const RandomScene random = randomScene(seed);
    const bool space = random.kind == RandomKind::space;
    EXPECT_EQ(random.scene.floor, !space) << seed;
    if (space) {
      EXPECT_EQ(random.scene.gravity.magnitude, 0.0) << seed;
    }
  }
}

// Half of the draws lie below the geometric mean; 4000 draws are within four standard deviations, 0.5 / sqrt(4000) each.
TEST(RandomDraw, IsEvenInTheLogarithm) {
  RandomDraw draw(7);
  constexpr int kDraws = 4000;
  int below = 0;
  for (int i = 0; i < kDraws; ++i) {
    const double value = draw.logBetween(1e-3, 10.0);
    EXPECT_TRUE(isInside(value, {1e-3, 10.0, ""}));
    below += value < 0.1 ? 1 : 0;
  }
  EXPECT_NEAR(below / static_cast<double>(kDraws), 0.5, 4.0 * 0.5 / std::sqrt(kDraws));
}

TEST(RandomDraw, PicksByWeight) {
  RandomDraw draw(7);
  constexpr int kDraws = 4000;
  std::array<int, 3> counts{};
  for (int i = 0; i < kDraws; ++i) ++counts[draw.pick({1.0, 0.0, 3.0})];
  EXPECT_EQ(counts[1], 0);
  EXPECT_NEAR(counts[0] / static_cast<double>(kDraws), 0.25, 4.0 * std::sqrt(0.25 * 0.75 / kDraws));
}

}  // namespace
}  // namespace springtower
