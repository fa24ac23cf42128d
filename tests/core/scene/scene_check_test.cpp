#include "core/error.h"
#include "core/random.h"
#include "core/scene/scene.h"

#include <cmath>
#include <functional>
#include <gmock/gmock.h>
#include <limits>
#include <numbers>
#include <optional>

namespace springtower {
namespace {

using testing::ThrowsMessage;

constexpr double kHalfHeight_m = 0.0091;

BlockSpec blockAt(const Vec3& centre, double angle_deg = 0.0, const Vec3& axis = Vec3::UnitZ()) {
  BlockSpec block;
  block.centre = centre;
  block.orientation = Eigen::AngleAxisd(angle_deg * std::numbers::pi / 180.0, axis.normalized());
  return block;
}

Scene sceneOf(std::vector<BlockSpec> blocks) {
  Scene scene;
  scene.blocks = std::move(blocks);
  return scene;
}

auto checking(const Scene& scene) {
  return [scene] { checkScene(scene, "test"); };
}

TEST(StartingPlaces, ThatTouchAreFine) {
  const double stacked = 3.0 * kHalfHeight_m;
  EXPECT_NO_THROW(checkScene(sceneOf({blockAt({0, 0, kHalfHeight_m})}), "on the floor"));
  EXPECT_NO_THROW(checkScene(sceneOf({blockAt({0, 0, kHalfHeight_m}), blockAt({0, 0, stacked})}), "face on face"));
  EXPECT_NO_THROW(checkScene(sceneOf({blockAt({0, 0, kHalfHeight_m}), blockAt({0, 0, stacked}, 37.0)}), "face on turned face"));
  EXPECT_NO_THROW(checkScene(sceneOf({blockAt({0, 0, kHalfHeight_m}), blockAt({0.081, 0, kHalfHeight_m})}), "side by side"));
  EXPECT_NO_THROW(checkScene(sceneOf({blockAt({0, 0, kHalfHeight_m}), blockAt({0.081, 0.0267, stacked})}), "corner at corner"));
}

// Four tolerances, of the larger of the one in force and the default one, up to a tenth of the thinner block.
TEST(StartingPlaces, MayOverlapAsAtRest) {
  const auto overlapping = [](double depth, std::optional<double> tolerance_m, double side_m) {
    BlockSpec lower = blockAt({0, 0, 0.5 * side_m - 0.99 * depth});
    BlockSpec upper = blockAt({0, 0, 1.5 * side_m - 1.98 * depth});
    lower.dimensions.z() = upper.dimensions.z() = side_m;
    Scene scene = sceneOf({lower, upper});
    scene.settings.tolerance_m = tolerance_m;
    return scene;
  };
  struct Case {
    std::optional<double> tolerance_m;
    double side_m;
    double allowed_m;
  };
  for (const Case& of : {Case{{}, 0.0182, 2e-4}, Case{1e-5, 0.0182, 2e-4}, Case{1e-4, 0.0182, 4e-4}, Case{{}, 0.0091, 1e-4},
                         Case{1e-3, 0.0182, 0.00182}}) {
    EXPECT_NO_THROW(checkScene(overlapping(of.allowed_m, of.tolerance_m, of.side_m), "test")) << of.allowed_m;
    EXPECT_THROW(checkScene(overlapping(1.03 * of.allowed_m, of.tolerance_m, of.side_m), "test"), InputError) << of.allowed_m;
  }
}

TEST(StartingPlaces, InsideTheFloorAreNamedWithTheirDepth) {
  EXPECT_THAT(
      checking(sceneOf({blockAt({0, 0, kHalfHeight_m}), blockAt({0.2, 0, 0.0081})})),
      ThrowsMessage<InputError>("test: block 1: expected a start up to 0.2 mm inside the floor z = 0, as at rest, got 1 mm"));
  Scene withoutFloor = sceneOf({blockAt({0, 0, -0.5})});
  withoutFloor.floor = false;
  EXPECT_NO_THROW(checkScene(withoutFloor, "test"));
}

TEST(StartingPlaces, InsideOneAnotherNameBothBlocksAndTheDepth) {
  const BlockSpec first = blockAt({0, 0, kHalfHeight_m});
  EXPECT_THAT(checking(sceneOf({blockAt({1, 0, kHalfHeight_m}), first, blockAt({0.0, 0.0, 0.0263}, 90.0)})),
              ThrowsMessage<InputError>(
                  "test: block 1 and block 2: expected a start up to 0.2 mm inside each other, as at rest, got 1 mm"));
  EXPECT_THAT(checking(sceneOf({first, first})),
              ThrowsMessage<InputError>(
                  "test: block 0 and block 1: expected a start up to 0.2 mm inside each other, as at rest, got 18.2 mm"));
}

// A cube of side 1 balanced on its corner, half a diagonal above the flat one below: only the flat one's face separates them,
// whichever of the two comes first.
TEST(StartingPlaces, OfTurnedBlocksAreJudgedByTheirBoxes) {
  BlockSpec flat = blockAt({0, 0, 0.5});
  BlockSpec onCorner = blockAt({0.2, 0.1, 0});
  flat.dimensions = onCorner.dimensions = Vec3::Ones();
  onCorner.orientation = Eigen::AngleAxisd(std::acos(1.0 / std::numbers::sqrt3), Vec3(1, -1, 0).normalized());
  const double touching = 1.0 + std::numbers::sqrt3 / 2.0;
  for (const bool flatFirst : {true, false}) {
    onCorner.centre.z() = touching;
    EXPECT_NO_THROW(checkScene(flatFirst ? sceneOf({flat, onCorner}) : sceneOf({onCorner, flat}), "test"));
    onCorner.centre.z() = touching - 0.02;
    EXPECT_THAT(checking(flatFirst ? sceneOf({flat, onCorner}) : sceneOf({onCorner, flat})),
                ThrowsMessage<InputError>(
                    "test: block 0 and block 1: expected a start up to 10.99 mm inside each other, as at rest, got 20 mm"));
  }
}

// Two bars crossed edge on edge, one turned 45 degrees about its length along x, the other about its length along y: only the
// product of the two edges separates them.
TEST(StartingPlaces, OfCrossedEdgesAreJudgedByTheProductOfTheEdges) {
  const auto bars = [](double distance) {
    BlockSpec lower = blockAt({0, 0, 10.0}, 45.0, Vec3::UnitX());
    BlockSpec upper = blockAt({0, 0, 10.0 + distance}, 45.0, Vec3::UnitY());
    lower.dimensions = {4.0, 1.0, 1.0};
    upper.dimensions = {1.0, 4.0, 1.0};
    return sceneOf({lower, upper});
  };
  EXPECT_NO_THROW(checkScene(bars(std::numbers::sqrt2), "test"));
  EXPECT_THAT(checking(bars(std::numbers::sqrt2 - 0.02)),
              ThrowsMessage<InputError>(
                  "test: block 0 and block 1: expected a start up to 10.99 mm inside each other, as at rest, got 20 mm"));
}

// Whether two boxes share a point, so far inside both that they overlap by more than is allowed, found by sampling both: the
// answer of the separating axes must not contradict it.
TEST(StartingPlaces, AreRefusedWheneverABoxHoldsAPointOfAnother) {
  RandomStream random(11, 0);
  const auto inside = [](const BlockSpec& block, const Vec3& point) {
    const Vec3 own = block.orientation.conjugate() * (point - block.centre);
    return (own.cwiseAbs().array() < 0.5 * block.dimensions.array() - 2e-4).all();
  };
  int overlapping = 0;
  int accepted = 0;
  for (int trial = 0; trial < 400; ++trial) {
    const auto vector = [&] { return Vec3{random.normal(), random.normal(), random.normal()}; };
    BlockSpec first = blockAt({0, 0, 1.0}, 360.0 * random.uniform(), vector());
    BlockSpec second = blockAt(first.centre + 0.025 * vector(), 360.0 * random.uniform(), vector());
    bool sharesAPoint = false;
    for (int sample = 0; sample < 3000 && !sharesAPoint; ++sample) {
      const Vec3 own =
          (Vec3{random.uniform(), random.uniform(), random.uniform()}.array() - 0.5) * (first.dimensions.array() - 2e-4);
      sharesAPoint = inside(second, first.orientation * own + first.centre);
    }
    bool refused = false;
    try {
      checkScene(sceneOf({first, second}), "test");
    } catch (const InputError&) {
      refused = true;
    }
    if (sharesAPoint) {
      ++overlapping;
      EXPECT_TRUE(refused) << "trial " << trial;
    }
    if (!refused) ++accepted;
  }
  EXPECT_GT(overlapping, 50);
  EXPECT_GT(accepted, 50);
}

TEST(StartingPlaces, OfManyBlocksAreComparedWhereverTheyStand) {
  Scene towers;
  for (int x = 0; x < 10; ++x) {
    for (int y = 0; y < 10; ++y) {
      for (BlockSpec block : towerScene(18).blocks) {
        block.centre += Vec3(0.1 * x, 0.1 * y, 0.0);
        towers.blocks.push_back(block);
      }
    }
  }
  EXPECT_NO_THROW(checkScene(towers, "towers"));
  for (const std::size_t intruder : {std::size_t{3}, std::size_t{2727}, towers.blocks.size() - 1}) {
    Scene scene = towers;
    scene.blocks[intruder].centre.z() -= 0.003;
    EXPECT_THROW(checkScene(scene, "towers"), InputError) << "block " << intruder;
  }
}

TEST(SceneLimits, NameTheBlockTheValueAndWhatIsAllowed) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinity = std::numeric_limits<double>::infinity();
  const std::pair<std::function<void(Scene&)>, const char*> mistakes[] = {
      {[](Scene& s) { s.blocks[1].mass = -0.02; }, "test: block 1: mass: expected 1e-09 to 1000000 kg, got -0.02"},
      {[](Scene& s) { s.blocks[1].mass = 0.0; }, "test: block 1: mass: expected 1e-09 to 1000000 kg, got 0"},
      {[=](Scene& s) { s.blocks[0].centre.y() = nan; }, "test: block 0: centre y: expected -10000 to 10000 m, got nan"},
      {[](Scene& s) { s.blocks[0].dimensions.z() = 1e-6; }, "test: block 0: dimension z: expected 1e-05 to 100 m, got 1e-06"},
      {[](Scene& s) { s.blocks[0].dimensions.x() = 101.0; }, "test: block 0: dimension x: expected 1e-05 to 100 m, got 101"},
      {[=](Scene& s) { s.blocks[0].velocity.x() = -infinity; },
       "test: block 0: velocity x: expected -1000 to 1000 m/s, got -inf"},
      {[](Scene& s) { s.blocks[0].spin.z() = 1e9; }, "test: block 0: spin z: expected -1000 to 1000 rad/s, got 1000000000"},
      {[](Scene& s) { s.blocks[0].orientation.coeffs() *= 2.0; },
       "test: block 0: length of the orientation's quaternion: expected 0.999999999 to 1.000000001, got 2"},
      {[](Scene& s) { s.blocks.clear(); }, "test: number of blocks: expected 1 to 200000, got 0"},
      {[](Scene& s) { s.seconds = -1.0; }, "test: seconds: expected 0.001 to 10000000 s, got -1"},
      {[](Scene& s) { s.staticFriction = -0.4; }, "test: static friction: expected 0 to 10, got -0.4"},
      {[](Scene& s) { s.kineticFriction = 0.5; }, "test: kinetic friction: expected 0 to 0.4 (the static one), got 0.5"},
      {[](Scene& s) { s.gravity.magnitude = -9.81; }, "test: gravity: magnitude: expected 0 to 1000 m/s2, got -9.81"},
      {[=](Scene& s) { s.gravity.tilt_deg = nan; }, "test: gravity: tilt: expected -180 to 180 deg, got nan"},
      {[](Scene& s) { s.settings.frame_s = 0.0; }, "test: frame_s: expected 0.0001 to 0.1 s, got 0"},
      {[](Scene& s) { s.forces.push_back({.block = 2, .end_s = 1.0}); }, "test: force 0: block: expected 0 to 1, got 2"},
      {[](Scene& s) { s.forces.push_back({.block = 0, .corner = 8, .end_s = 1.0}); },
       "test: force 0: corner: expected -1 to 7 (-1 is the centre), got 8"},
      {[](Scene& s) { s.forces.push_back({.start_s = 2.0, .end_s = 1.0}); },
       "test: force 0: end: expected 2 to 10000000 s, got 1"},
  };
  for (const auto& [makeMistake, message] : mistakes) {
    Scene scene = sceneOf({blockAt({0, 0, kHalfHeight_m}), blockAt({0.2, 0, kHalfHeight_m})});
    ASSERT_NO_THROW(checkScene(scene, "test"));
    makeMistake(scene);
    EXPECT_THAT(checking(scene), ThrowsMessage<InputError>(message));
  }
}

TEST(SceneLimits, AllowTwoHundredThousandBlocksAndNoMore) {
  Scene scene;
  for (int x = 0; x < 2000; ++x) {
    for (int y = 0; y < 100; ++y) scene.blocks.push_back(blockAt({0.1 * x, 0.1 * y, kHalfHeight_m}));
  }
  EXPECT_NO_THROW(checkScene(scene, "test"));
  scene.blocks.push_back(blockAt({0, -1, kHalfHeight_m}));
  EXPECT_THAT(checking(scene), ThrowsMessage<InputError>("test: number of blocks: expected 1 to 200000, got 200001"));
}

}  // namespace
}  // namespace springtower
