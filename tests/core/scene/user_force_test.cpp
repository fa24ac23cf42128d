#include "core/scene/user_force.h"

#include "core/error.h"
#include "core/scene/scene.h"
#include "tests/support/says.h"

#include <gmock/gmock.h>

namespace springtower {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

// 2 N along x and 3 N m about z, from 1 s to 3 s; the force grows to 6 N.
UserForce ramp() {
  UserForce force;
  force.force = Vec3(2.0, 0.0, 0.0);
  force.forceAtEnd = Vec3(6.0, 0.0, 0.0);
  force.torque = Vec3(0.0, 0.0, 3.0);
  force.start_s = 1.0;
  force.end_s = 3.0;
  return force;
}

TEST(UserForce, ChangesLinearlyFromStartToEnd) {
  EXPECT_EQ(ramp().at(1.0).force.x(), 2.0);
  EXPECT_EQ(ramp().at(2.0).force.x(), 4.0);
  EXPECT_EQ(ramp().at(3.0).force.x(), 6.0);
  EXPECT_EQ(ramp().at(2.5).torque.z(), 3.0);
}

// The integral from 1 s to t is 2 (t - 1) + (t - 1)^2.
TEST(UserForce, TimesTheTimeItsMeanIsTheImpulse) {
  EXPECT_DOUBLE_EQ(2.5 * ramp().meanOver(0.0, 2.5).force.x(), 2.0 * 1.5 + 1.5 * 1.5);
  EXPECT_DOUBLE_EQ(4.0 * ramp().meanOver(0.0, 4.0).force.x(), 8.0);
  EXPECT_DOUBLE_EQ(2.0 * ramp().meanOver(2.0, 4.0).force.x(), 8.0 - 3.0);
  EXPECT_DOUBLE_EQ(0.5 * ramp().meanOver(1.5, 2.0).force.x(), 3.0 - 1.25);
  EXPECT_DOUBLE_EQ(4.0 * ramp().meanOver(0.0, 4.0).torque.z(), 6.0);
  EXPECT_EQ(ramp().meanOver(0.0, 1.0).force.x(), 0.0);
  EXPECT_EQ(ramp().meanOver(3.0, 4.0).force.x(), 0.0);
}

TEST(UserForce, OverAWholeStepAConstantOneIsItsMean) {
  UserForce force = ramp();
  force.forceAtEnd.reset();
  EXPECT_EQ(force.meanOver(1.1, 1.1 + 1.0 / 480.0).force.x(), 2.0);
}

TEST(UserForce, HasItsPointInItsBlockAndOnlyOne) {
  Scene scene = towerScene(1);
  scene.forces = {ramp()};
  scene.forces[0].point = Vec3(0.0405, -0.01335, 0.0091);
  EXPECT_NO_THROW(checkScene(scene, "test"));
  scene.forces[0].point->z() = 0.0092;
  EXPECT_THAT(
      [&] { checkScene(scene, "test"); },
      ThrowsMessage<InputError>(HasSubstr("force 0: point z: expected -0.0091 to 0.0091 m (within the block), got 0.0092")));
  scene.forces[0].point = Vec3::Zero();
  scene.forces[0].corner = 3;
  EXPECT_THAT([&] { checkScene(scene, "test"); }, ThrowsMessage<InputError>(says("corner: expected -1 to -1 ..., got 3")));
  scene.forces[0] = ramp();
  scene.forces[0].torqueAtEnd = Vec3(0.0, 2e6, 0.0);
  EXPECT_THAT([&] { checkScene(scene, "test"); },
              ThrowsMessage<InputError>(HasSubstr("torque at the end y: expected -1000000 to 1000000 N m, got 2000000")));
}

}  // namespace
}  // namespace springtower
