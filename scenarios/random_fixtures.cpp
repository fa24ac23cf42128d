#include "scenarios/random_fixtures.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace springtower {
namespace {

constexpr double kShareWithSurfaces = 0.5;
constexpr double kShareWithFixtures = 0.3;

double drawRestitution(RandomDraw& draw) {
  return std::array{0.0, 1.0, draw.between(0.0, 1.0)}[draw.pick({0.15, 0.05, 0.8})];
}

std::size_t drawBlockOf(RandomDraw& draw, const Scene& scene) {
  return static_cast<std::size_t>(draw.whole(0, static_cast<int>(scene.blocks.size()) - 1));
}

void drawFrictionPairs(RandomDraw& draw, double most, Scene& scene) {
  const int pairs = draw.whole(1, 3);
  for (int p = 0; p < pairs; ++p) {
    FrictionPair pair;
    pair.a = static_cast<int>(drawBlockOf(draw, scene));
    pair.b = draw.chance(0.3) && scene.floor ? -1 : static_cast<int>(drawBlockOf(draw, scene));
    pair.friction = drawFriction(draw, most);
    const auto same = [&](const FrictionPair& other) {
      return (other.a == pair.a && other.b == pair.b) || (other.a == pair.b && other.b == pair.a);
    };
    const bool known = std::any_of(scene.frictionPairs.begin(), scene.frictionPairs.end(), same);
    if (pair.a != pair.b && !known) scene.frictionPairs.push_back(pair);
  }
}

Drive drawDrive(RandomDraw& draw, const Scene& scene, int block) {
  Drive drive;
  drive.block = block;
  Vec3 direction = draw.inBall(1.0);
  if (scene.floor) direction.z() = draw.chance(0.3) ? std::abs(direction.z()) : 0.0;
  const double length = std::max(1e-3, direction.norm());
  const double speed = draw.logBetween(1e-3, kMaxDriveSpeed_m_s);
  const double turn = draw.logBetween(1e-2, kMaxDriveSpin_rad_s);
  const double way = draw.logBetween(1e-4, kMaxDriveAmplitude_m);
  const double frequency = draw.logBetween(0.2, kMaxDriveFrequency_hz);
  const std::size_t kind = draw.pick({0.4, 0.3, 0.3});
  if (kind == 0) drive.velocity = direction * (speed / length);
  if (kind == 1) drive.spin = scene.floor ? Vec3(0.0, 0.0, turn) : Vec3(direction * (turn / length));
  if (kind == 2) {
    if (scene.floor) direction.z() = 0.0;  // on its way back it would come down
    drive.amplitude = direction * (way / length);
    drive.frequency_hz = frequency;
  }
  if (draw.chance(0.5)) drive.start_s = draw.between(0.0, 0.5);
  if (draw.chance(0.5)) drive.end_s = drive.start_s + draw.between(0.1, 1.0);
  return drive;
}

}  // namespace

Friction drawFriction(RandomDraw& draw, double most) {
  Friction friction;
  friction.staticFriction = draw.chance(0.1) ? 0.0 : draw.between(0.0, most);
  friction.kineticFriction = friction.staticFriction * (draw.chance(0.4) ? draw.between(0.3, 1.0) : 1.0);
  return friction;
}

void drawSurfaces(RandomDraw& draw, double most, Scene& scene) {
  if (!draw.chance(kShareWithSurfaces)) return;
  scene.restitution = drawRestitution(draw);
  const bool blocks = draw.chance(0.3);
  for (BlockSpec& block : scene.blocks) {
    const bool ownRestitution = draw.chance(0.3);
    const double restitution = drawRestitution(draw);
    const bool ownFriction = draw.chance(0.3);
    const Friction friction = drawFriction(draw, most);
    if (!blocks || block.row >= 0) continue;
    if (ownRestitution) block.restitution = restitution;
    if (ownFriction) block.friction = friction;
  }
  if (draw.chance(0.2) && scene.floor) scene.floorFriction = drawFriction(draw, most);
  if (draw.chance(0.2)) drawFrictionPairs(draw, most, scene);
}

void drawFixtures(RandomDraw& draw, Scene& scene) {
  if (!draw.chance(kShareWithFixtures)) return;
  const bool driven = draw.chance(0.4);
  const int count = driven ? 1 : std::min(draw.whole(1, 3), static_cast<int>(scene.blocks.size()) - 1);
  for (int f = 0; f < count; ++f) {
    const std::size_t chosen = drawBlockOf(draw, scene);
    BlockSpec& block = scene.blocks[chosen];
    block.fixed = true;
    block.velocity = block.spin = Vec3::Zero();
    if (driven) scene.drives = {drawDrive(draw, scene, static_cast<int>(chosen))};
  }
}

}  // namespace springtower
