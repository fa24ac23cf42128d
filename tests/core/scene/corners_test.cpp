#include "core/scene/corners.h"

#include "core/error.h"
#include "tests/support/says.h"

#include <gmock/gmock.h>
#include <numbers>

namespace springtower {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

BlockSpec turnedBlock() {
  BlockSpec block;
  block.centre = Vec3(0.1, -0.2, 0.5);
  block.orientation = Eigen::AngleAxisd(1.1, Vec3(1, 2, 3).normalized());
  return block;
}

BlockSpec placed(const CornerPlaces& corners) {
  BlockSpec block;
  placeByCorners(corners, block);
  return block;
}

TEST(Corners, OfACuboidGiveItsPlaceAndNoStrain) {
  const BlockSpec block = turnedBlock();
  const BlockSpec found = placed(cornersOf(block));
  EXPECT_LT((found.centre - block.centre).norm(), 1e-15);
  EXPECT_LT(found.orientation.angularDistance(block.orientation), 1e-14);
  for (const Vec3& apart : *found.strain) EXPECT_LT(apart.norm(), 1e-15);
}

TEST(Corners, AreKeptWithTheirStrain) {
  CornerPlaces corners = cornersOf(turnedBlock());
  corners[3] += Vec3(1e-5, -2e-5, 3e-6);
  corners[6] -= Vec3(0.0, 1e-5, 1e-5);
  const CornerPlaces again = cornersOf(placed(corners));
  for (std::size_t c = 0; c < corners.size(); ++c) EXPECT_LT((again[c] - corners[c]).norm(), 1e-15);
}

// A corner a tenth of a millimetre off is strain, a whole one is a mistake; so are two corners that have changed places, and the
// corners of another cuboid.
TEST(Corners, FarFromACuboidAreRefused) {
  const auto checking = [](const CornerPlaces& corners) {
    return [=] {
      Scene scene;
      scene.blocks = {placed(corners)};
      checkScene(scene, "test");
    };
  };
  CornerPlaces corners = cornersOf(turnedBlock());
  corners[5].z() += 1e-4;
  EXPECT_NO_THROW(checking(corners)());
  corners[5].z() += 1e-3;
  EXPECT_THAT(checking(corners),
              ThrowsMessage<InputError>(says("expected up to 0.2 mm from that of a cuboid of 0.081 x 0.0267 x 0.0182 m "
                                             "(corners in the order of run --poses), got ... mm")));
  corners = cornersOf(turnedBlock());
  std::swap(corners[2], corners[3]);
  EXPECT_THAT(checking(corners), ThrowsMessage<InputError>(HasSubstr("mm from that of a cuboid")));
  BlockSpec larger = turnedBlock();
  larger.dimensions.z() += 1e-3;
  EXPECT_THAT(checking(cornersOf(larger)), ThrowsMessage<InputError>(HasSubstr("mm from that of a cuboid")));
}

}  // namespace
}  // namespace springtower
