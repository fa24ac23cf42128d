// What queries of a world return, against closed forms.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <springtower/inputs.h>
#include <springtower/query.h>

namespace springtower::api {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

constexpr double kBlockWeight_n = 0.0196 * 9.81;

// Two blocks, one on the other, and a third aside.
Scene stackAndOne() {
  Scene scene;
  scene.blocks.resize(3);
  scene.blocks[0].centre.z = 0.0091;
  scene.blocks[1].centre.z = 0.0273;
  scene.blocks[2].centre = {0.5, 0.0, 0.0091};
  scene.settings.sleep = Sleep::off;
  return scene;
}

TEST(Query, ContactsCarryTheWeightOfWhatLiesAbove) {
  World world(stackAndOne());
  EXPECT_THAT(contacts(world), IsEmpty()) << "nothing has been looked at before prepare";
  world.prepare();
  ASSERT_EQ(world.step(60), std::nullopt);
  double floor_n = 0.0;
  double between_n = 0.0;
  for (const Contact& contact : contacts(world)) {
    EXPECT_GT(contact.normalForce_n, 0.0);
    EXPECT_GT(contact.depth_m, 0.0);
    EXPECT_LT(contact.depth_m, world.tolerance_m());
    EXPECT_FALSE(contact.sliding);
    const bool onFloor = contact.lower == kFloor;
    EXPECT_NEAR(contact.point.z, onFloor ? 0.0 : 0.0182, world.tolerance_m());
    (onFloor ? floor_n : between_n) += contact.normalForce_n;
  }
  EXPECT_NEAR(floor_n, 3.0 * kBlockWeight_n, 1e-3 * kBlockWeight_n);
  EXPECT_NEAR(between_n, kBlockWeight_n, 1e-3 * kBlockWeight_n);
  double onFirst_n = 0.0;
  for (const Contact& contact : contactsOn(world, 0)) onFirst_n += contact.normalForce_n;
  EXPECT_NEAR(onFirst_n, 3.0 * kBlockWeight_n, 1e-3 * kBlockWeight_n);
}

TEST(Query, EnergiesOfABlockThatFlies) {
  Scene scene;
  scene.floor = false;
  scene.blocks.resize(1);
  scene.blocks[0].centre.z = 2.0;
  scene.blocks[0].velocity.x = 3.0;
  const World world(scene);
  const Energy now = energy(world);
  EXPECT_NEAR(now.kinetic, 0.5 * 0.0196 * 9.0, 1e-12);
  EXPECT_NEAR(now.gravity, kBlockWeight_n * 2.0, 1e-12);
  EXPECT_NEAR(now.springs + now.contacts, 0.0, 1e-12);
  EXPECT_EQ(now.total(), now.kinetic + now.gravity + now.springs + now.contacts);
}

TEST(Query, PenetrationIsThatOfTheDeepestPair) {
  World world(stackAndOne());
  EXPECT_NEAR(deepestPenetration(world).depth_m, 0.0, 1e-9);
  world.prepare();
  ASSERT_EQ(world.step(60), std::nullopt);
  const Penetration deepest = deepestPenetration(world);
  EXPECT_GT(deepest.depth_m, 0.0);
  EXPECT_LE(deepest.depth_m, world.tolerance_m());
  EXPECT_NE(deepest.first, kFloor);
}

TEST(Query, IslandsAreWhatTouches) {
  World world(stackAndOne());
  EXPECT_THAT(islandOf(world, 0), IsEmpty());
  world.prepare();
  ASSERT_EQ(world.step(2), std::nullopt);
  EXPECT_THAT(islandOf(world, 0), ElementsAre(0, 1));
  EXPECT_THAT(islandOf(world, 1), ElementsAre(0, 1));
  EXPECT_THAT(islandOf(world, 2), ElementsAre(2));
}

TEST(Query, BlocksAtRestFallAsleep) {
  Scene scene = stackAndOne();
  scene.settings.sleep = Sleep::on;
  World world(scene);
  world.prepare();
  EXPECT_FALSE(isAsleep(world, 0));
  EXPECT_FALSE(isAtRest(world));
  ASSERT_EQ(world.step(240), std::nullopt);
  EXPECT_TRUE(isAtRest(world));
  EXPECT_TRUE(allAsleep(world));
  EXPECT_TRUE(isAsleep(world, 0));
  EXPECT_THAT(islandOf(world, 0), IsEmpty());
  kick(world, 2, {0.01, 0.0, 0.0});
  EXPECT_FALSE(allAsleep(world));
  ASSERT_EQ(world.step(), std::nullopt);
  EXPECT_THAT(islandOf(world, 2), ElementsAre(2));
  EXPECT_TRUE(isAsleep(world, 0));
}

}  // namespace
}  // namespace springtower::api
