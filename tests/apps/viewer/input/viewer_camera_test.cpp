#include "apps/viewer/input/camera.h"
#include "core/random.h"
#include "solver/world/simulation.h"

#include <gtest/gtest.h>
#include <numbers>

namespace springtower {
namespace {

constexpr Viewport kViewport{1280, 800};

// Slow and plain: each face as a plane and four half planes.
std::optional<Pick> pickByPlanes(const ParticleArray& position, const Ray& ray) {
  std::optional<Pick> nearest;
  for (std::size_t b = 0; b < position.blockCount(); ++b) {
    for (std::size_t f = 0; f < kFaces; ++f) {
      std::array<Vec3, 4> corner;
      for (std::size_t i = 0; i < 4; ++i) corner[i] = position.at(b, static_cast<std::size_t>(kFaceCorners[f][i]));
      const Vec3 normal = (corner[1] - corner[0]).cross(corner[2] - corner[0]);
      const double distance = normal.dot(corner[0] - ray.origin) / normal.dot(ray.direction);
      if (!(distance > 0.0) || (nearest && nearest->distance <= distance)) continue;
      const Vec3 point = ray.origin + distance * ray.direction;
      bool inside = true;
      for (std::size_t i = 0; i < 4; ++i) {
        inside = inside && (corner[(i + 1) % 4] - corner[i]).cross(point - corner[i]).dot(normal) >= 0.0;
      }
      if (inside) nearest = Pick{blockId(b), f, distance, point};
    }
  }
  return nearest;
}

TEST(ViewerCamera, ItsAxesAreAFrameThatLooksAtTheTarget) {
  Camera camera;
  for (int i = 0; i < 50; ++i) {
    orbit(camera, 0.37, i % 2 == 0 ? 0.61 : -0.5);
    const CameraFrame frame = cameraFrame(camera);
    EXPECT_NEAR((frame.right.cross(frame.up) - frame.back).norm(), 0.0, 1e-14);
    EXPECT_NEAR(frame.right.z(), 0.0, 0.0);
    EXPECT_GT(frame.up.z(), 0.0);
    EXPECT_NEAR((frame.eye - camera.distance * frame.back - camera.target).norm(), 0.0, 1e-14);
  }
}

TEST(ViewerCamera, TheDefaultReadsBitCodesFromLeftToRight) {
  const CameraFrame frame = cameraFrame(Camera{});
  EXPECT_GT(frame.eye.x(), 0.0);
  EXPECT_LT(frame.eye.y(), 0.0);
  EXPECT_GT(frame.right.x(), 0.0);
  EXPECT_GT(frame.right.y(), 0.0);
}

TEST(ViewerCamera, GoesAllTheWayRoundAndOverTheTop) {
  Camera camera;
  const double azimuth = camera.azimuth;
  for (int i = 0; i < 100; ++i) orbit(camera, 2.0 * std::numbers::pi / 100, 0.1);
  EXPECT_NEAR(camera.azimuth, azimuth, 1e-12);
  EXPECT_NEAR(camera.elevation, 89.0 * std::numbers::pi / 180.0, 1e-12);
  for (int i = 0; i < 100; ++i) orbit(camera, 0.0, -0.1);
  EXPECT_NEAR(camera.elevation, -5.0 * std::numbers::pi / 180.0, 1e-12);
  for (int i = 0; i < 200; ++i) zoom(camera, 1.0);
  EXPECT_DOUBLE_EQ(camera.distance, 0.05);
  for (int i = 0; i < 200; ++i) zoom(camera, -1.0);
  EXPECT_DOUBLE_EQ(camera.distance, 20.0);
}

TEST(ViewerCamera, ARayMeetsThePointThatIsSeenThere) {
  Camera camera;
  RandomStream random(7, 1);
  for (int i = 0; i < 500; ++i) {
    orbit(camera, random.uniform(), random.uniform() - 0.5);
    const Vec3 point = camera.target + 0.2 * Vec3{random.uniform(), random.uniform(), random.uniform()};
    const auto seen = seenAt(camera, kViewport, point);
    ASSERT_TRUE(seen);
    const Ray ray = rayThrough(camera, kViewport, seen->x(), seen->y());
    EXPECT_NEAR((point - ray.origin).cross(ray.direction).norm(), 0.0, 1e-12);
    // And where OpenGL draws it.
    const Eigen::Vector4f clip = clipFromWorld(camera, kViewport) * point.cast<float>().homogeneous();
    EXPECT_NEAR(0.5 * (static_cast<double>(clip.x() / clip.w()) + 1.0) * kViewport.width, seen->x(), 0.01);
    EXPECT_NEAR(0.5 * (1.0 - static_cast<double>(clip.y() / clip.w())) * kViewport.height, seen->y(), 0.01);
    EXPECT_LT(std::abs(clip.z()), clip.w());
    // A pixel aside is a pixel's metres aside, in the plane of the screen.
    const CameraFrame frame = cameraFrame(camera);
    const auto aside = seenAt(camera, kViewport, point + metresPerPixel(camera, kViewport, point) * frame.right);
    EXPECT_NEAR(aside->x() - seen->x(), 1.0, 1e-9);
  }
  EXPECT_FALSE(seenAt(camera, kViewport, cameraFrame(camera).eye + cameraFrame(camera).back));
}

TEST(ViewerCamera, ShowsTheWholeTower) {
  const Simulation simulation(towerScene(30));
  Camera camera;
  showAll(camera, simulation.state.position);
  for (std::size_t b = 0; b < 90; ++b) {
    for (std::size_t c = 0; c < kCorners; ++c) {
      const auto seen = seenAt(camera, kViewport, simulation.state.position.at(b, c));
      ASSERT_TRUE(seen);
      EXPECT_TRUE(seen->x() > 0 && seen->x() < kViewport.width && seen->y() > 0 && seen->y() < kViewport.height);
    }
  }
}

TEST(ViewerPicking, FindsTheFaceThatIsSeen) {
  const Simulation simulation(towerScene(3));
  Camera camera;
  camera.azimuth = 0.0;
  camera.elevation = 0.0;
  camera.target = {0.0, 0.0, 0.0091};  // the middle of the lowest row, which lies along x: its ends are seen
  const auto pick = pickBlock(simulation.state.position, rayThrough(camera, kViewport, 640, 400));
  ASSERT_TRUE(pick);
  EXPECT_EQ(index(pick->block), 1U);
  EXPECT_EQ(pick->face, 1U);
  EXPECT_NEAR((pick->point - Vec3(0.0405, 0.0, 0.0091)).norm(), 0.0, 1e-9);
  EXPECT_NEAR(pick->distance, camera.distance - 0.0405, 1e-9);
  EXPECT_FALSE(pickBlock(simulation.state.position, rayThrough(camera, kViewport, 5, 5)));
  EXPECT_FALSE(pickBlock(simulation.state.position, {{1.0, 0.0, 0.01}, Vec3::UnitX()}));  // behind the eye
}

TEST(ViewerPicking, AgreesWithPlanesOnRandomRays) {
  Simulation simulation(towerScene(6));
  RandomStream random(3, 1);
  int hits = 0;
  for (int i = 0; i < 3000; ++i) {
    const Vec3 from{2.0 * random.uniform() - 1.0, 2.0 * random.uniform() - 1.0, random.uniform()};
    const Vec3 to{0.1 * random.uniform() - 0.05, 0.1 * random.uniform() - 0.05, 0.14 * random.uniform()};
    const Ray ray{from, (to - from).normalized()};
    const auto pick = pickBlock(simulation.state.position, ray);
    const auto plain = pickByPlanes(simulation.state.position, ray);
    ASSERT_EQ(pick.has_value(), plain.has_value()) << i;
    if (!pick) continue;
    ++hits;
    EXPECT_EQ(pick->block, plain->block);
    EXPECT_EQ(pick->face, plain->face);
    EXPECT_NEAR(pick->distance, plain->distance, 1e-12);
  }
  EXPECT_GT(hits, 1500);
}

}  // namespace
}  // namespace springtower
