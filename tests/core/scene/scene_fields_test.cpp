// Scenes as bytes: what a file can say comes back.
#include "core/scene/scene_fields.h"

#include "core/scene/corners.h"

#include <filesystem>
#include <gtest/gtest.h>
#include <string>

namespace springtower {
namespace {

std::string bytesOfScene(const Scene& scene) {
  ByteWriter writer;
  writer(scene);
  return writer.bytes();
}

Scene sceneOfBytes(const std::string& bytes) {
  ByteReader reader(bytes, "bytes");
  Scene scene;
  reader(scene);
  reader.end();
  return scene;
}

TEST(SceneFields, OfEverySceneFileComeBack) {
  int files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(SPRINGTOWER_SOURCE_DIR "/scenes")) {
    const Scene scene = sceneFromToml(entry.path().string());
    const Scene read = sceneOfBytes(bytesOfScene(scene));
    EXPECT_EQ(bytesOfScene(read), bytesOfScene(scene)) << entry.path();
    EXPECT_EQ(read.name, scene.name);
    EXPECT_EQ(read.blocks.size(), scene.blocks.size());
    EXPECT_EQ(read.moves.size(), scene.moves.size());
    EXPECT_EQ(read.seconds, scene.seconds);
    EXPECT_NO_THROW(checkScene(read, "bytes")) << entry.path();
    ++files;
  }
  EXPECT_GE(files, 14);
}

TEST(SceneFields, StrainAndWhatMayBeLeftOutComeBack) {
  Scene scene = towerScene(1);
  CornerPlaces strain;
  for (std::size_t c = 0; c < kCorners; ++c) strain[c] = Vec3(1e-7 * static_cast<double>(c), 0.0, -1e-8);
  scene.blocks[1].strain = std::make_shared<const CornerPlaces>(strain);
  scene.blocks[2].friction = Friction{0.5, 0.3};
  scene.floorFriction = Friction{0.2, 0.1};
  scene.frictionPairs = {{1, -1, {0.7, 0.6}}};
  scene.settings.tolerance_m = 2e-5;
  UserForce ramp;
  ramp.point = Vec3(0.01, 0.0, 0.0);
  ramp.forceAtEnd = Vec3(0.0, 1.0, 0.0);
  scene.forces = {ramp};
  const Scene read = sceneOfBytes(bytesOfScene(scene));
  ASSERT_NE(read.blocks[1].strain, nullptr);
  EXPECT_EQ(*read.blocks[1].strain, strain);
  EXPECT_EQ(read.blocks[0].strain, nullptr);
  EXPECT_EQ(read.blocks[2].friction, scene.blocks[2].friction);
  EXPECT_EQ(read.floorFriction, scene.floorFriction);
  EXPECT_EQ(read.frictionPairs.at(0).friction, scene.frictionPairs.at(0).friction);
  EXPECT_EQ(read.settings.tolerance_m, scene.settings.tolerance_m);
  EXPECT_EQ(read.forces.at(0).point, ramp.point);
  EXPECT_EQ(read.forces.at(0).forceAtEnd, ramp.forceAtEnd);
  EXPECT_EQ(read.forces.at(0).torqueAtEnd, std::nullopt);
}

}  // namespace
}  // namespace springtower
