#include "tests/support/changed_scene.h"

#include "core/rotation_vector.h"
#include "tests/support/random.h"

#include <cmath>
#include <numbers>
#include <numeric>
#include <utility>

namespace springtower {
namespace {

double radians(double degrees) {
  return degrees * std::numbers::pi / 180.0;
}

// A direction, without the move and the scale.
Vec3 directionAfter(const SceneChange& change, Vec3 direction) {
  if (change.mirrored) direction.x() *= -1.0;
  return rotationAbout(Vec3::UnitZ(), radians(change.turn_deg)) * direction;
}

// A vector of rotation keeps its sense along the mirror's normal, and has it reversed in its plane.
Vec3 spinAfter(const SceneChange& change, Vec3 spin) {
  if (change.mirrored) spin = Vec3(spin.x(), -spin.y(), -spin.z());
  return rotationAbout(Vec3::UnitZ(), radians(change.turn_deg)) * spin;
}

// A cuboid is its own mirror image, corners aside (placesBack).
Eigen::Quaterniond orientationAfter(const SceneChange& change, Eigen::Quaterniond orientation) {
  if (change.mirrored) orientation = Eigen::Quaterniond(orientation.w(), orientation.x(), -orientation.y(), -orientation.z());
  return (rotationAbout(Vec3::UnitZ(), radians(change.turn_deg)) * orientation).normalized();
}

std::vector<std::size_t> orderOf(std::size_t blocks, std::uint64_t seed) {
  std::vector<std::size_t> order(blocks);
  std::iota(order.begin(), order.end(), 0U);
  Random random{SplitMix64(seed)};
  for (std::size_t i = blocks; seed != 0 && i > 1; --i) {
    std::swap(order[i - 1], order[static_cast<std::size_t>(random.below(static_cast<std::int32_t>(i)))]);
  }
  return order;
}

}  // namespace

std::vector<SceneChange> sceneChanges(std::uint64_t seed) {
  Random random{SplitMix64(seed)};
  const auto angle = [&] { return random.between(-180.0, 180.0); };
  Vec3 far = Vec3::Zero();
  for (int a = 1; a >= 0; --a) far[a] = random.between(-1.0, 1.0);  // y first, by every compiler
  std::vector<SceneChange> all = {
      {.name = "mirrored", .mirrored = true},
      {.name = "turned by a right angle", .turn_deg = 90.0},
      {.name = "turned", .turn_deg = angle()},
      {.name = "turned otherwise", .turn_deg = angle()},
      {.name = "turned and mirrored", .turn_deg = angle(), .mirrored = true},
      {.name = "a kilometre away", .by = 1000.0 * far.normalized()},
      {.name = "blocks permuted", .order = random.generator() | 1U},
      {.name = "blocks permuted otherwise", .order = random.generator() | 1U},
      {.name = "ten times as large", .scale = 10.0, .masses = 1000.0},
      {.name = "a hundredth of the masses", .masses = 0.01},
      {.name = "a thousand times the masses", .masses = 1000.0},
  };
  all.push_back({"all at once", angle(), true, 10.0, 1000.0 * far.normalized(), 30.0, random.generator() | 1U});
  return all;
}

ChangedScene changed(const Scene& plain, const SceneChange& change) {
  ChangedScene after{change, plain, orderOf(plain.blocks.size(), change.order)};
  const double time = std::sqrt(change.scale);
  for (std::size_t b = 0; b < after.source.size(); ++b) {
    BlockSpec block = plain.blocks[after.source[b]];
    block.centre = change.scale * directionAfter(change, block.centre) + change.by;
    block.dimensions *= change.scale;
    block.orientation = orientationAfter(change, block.orientation);
    block.velocity = time * directionAfter(change, block.velocity);
    block.spin = spinAfter(change, block.spin) / time;
    block.mass *= change.masses;
    after.scene.blocks[b] = block;
  }
  Gravity& gravity = after.scene.gravity;
  gravity.direction_deg =
      std::remainder((change.mirrored ? 180.0 - gravity.direction_deg : gravity.direction_deg) + change.turn_deg, 360.0);
  gravity.sway_hz /= time;
  Settings& settings = after.scene.settings;
  settings.frame_s *= time;
  if (settings.tolerance_m) *settings.tolerance_m *= change.scale;
  after.scene.seconds *= time;
  return after;
}

ParticleArray placesBack(const ChangedScene& changed, const ParticleArray& position) {
  const SceneChange& change = changed.change;
  const Eigen::Quaterniond back = rotationAbout(Vec3::UnitZ(), -radians(change.turn_deg));
  ParticleArray places;
  places.resize(changed.source.size());
  for (std::size_t b = 0; b < changed.source.size(); ++b) {
    for (std::size_t c = 0; c < kCorners; ++c) {
      Vec3 place = back * Vec3((position.at(b, c) - change.by) / change.scale);
      if (change.mirrored) place.x() *= -1.0;
      // The mirror image of a corner on the positive side of the block's own x axis is one on the negative side.
      places.set(changed.source[b], change.mirrored ? c ^ 1U : c, place);
    }
  }
  return places;
}

double energyFactor(const SceneChange& change) {
  return change.masses * change.scale;
}

}  // namespace springtower
