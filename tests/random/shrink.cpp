#include "tests/random/shrink.h"

#include "core/error.h"
#include "core/scene/rotation.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fmt/format.h>
#include <type_traits>
#include <utility>
#include <vector>

namespace springtower {
namespace {

constexpr double kLeastShare = 0.98;  // a time that is shorter by less is not worth a change

double rounded(double value, int digits) {
  return std::strtod(fmt::format("{:.{}g}", value, digits).c_str(), nullptr);
}

Vec3 rounded(const Vec3& value, int digits) {
  return {rounded(value.x(), digits), rounded(value.y(), digits), rounded(value.z(), digits)};
}

std::size_t towerBlocksOf(const RandomScene& random) {
  const auto& blocks = random.scene.blocks;
  return static_cast<std::size_t>(std::count_if(blocks.begin(), blocks.end(), [](const auto& block) { return block.row >= 0; }));
}

// Tries changes, and keeps those that leave the fault.
class Shrinker {
 public:
  Shrinker(Shrunk& best, Fault fault, const JudgeFunction& judge, int mostJudged)
      : best_(best), fault_(fault), judge_(judge), mostJudged_(mostJudged) {}

  // Whether the scene as `change` makes it still has the fault; it is then the best so far.
  template <class Change>
  bool tries(const Change& change) {
    if (best_.judged >= mostJudged_) return false;
    RandomScene candidate = best_.random;
    try {
      change(candidate);
      checkScene(candidate.scene, candidate.scene.name);
    } catch (const InputError&) {
      return false;
    }
    ++best_.judged;
    Record record = judge_(candidate);
    if (!has(record, fault_)) return false;
    best_.random = std::move(candidate);
    best_.record = std::move(record);
    return true;
  }

  // One round of everything; whether anything changed.
  bool round() {
    bool changed = dropTower();
    changed = dropBlocks() || changed;
    changed = dropActions() || changed;
    changed = dropFixtures() || changed;
    changed = stopBlocks() || changed;
    changed = simplify() || changed;
    changed = shorten() || changed;
    return roundNumbers() || changed;
  }

 private:
  // Blocks of a tower as blocks of their own, which can be dropped one by one. Moves need the tower.
  bool dropTower() {
    if (best_.random.towerCode.empty()) return false;
    const bool alone = tries([](RandomScene& random) {
      random.towerCode.clear();
      random.scene.moves.clear();
      for (BlockSpec& block : random.scene.blocks) block.row = -1, block.position = 0;
    });
    return alone || dropPlaces();
  }

  // Places of the tower's code that can be empty.
  bool dropPlaces() {
    bool changed = false;
    for (std::size_t i = 0; i < best_.random.towerCode.size(); ++i) {
      if (best_.random.towerCode[i] != '1' && best_.random.towerCode[i] != 'L') continue;
      changed = tries([i](RandomScene& random) {
                  random.towerCode[i] = '0';
                  if (!random.scene.forces.empty()) throw InputError("forces count the tower's blocks");
                  rebuildTower(random, towerBlocksOf(random));
                }) ||
                changed;
    }
    return changed;
  }

  // First halves, then ever smaller parts, then single blocks.
  bool dropBlocks() {
    bool changed = false;
    for (std::size_t part = best_.random.scene.blocks.size() / 2; part > 0; part /= 2) {
      for (std::size_t first = 0; first < best_.random.scene.blocks.size();) {
        const bool dropped = tries([&](RandomScene& random) { drop(random, first, part); });
        changed = changed || dropped;
        if (!dropped) first += part;
      }
    }
    return changed;
  }

  static void drop(RandomScene& random, std::size_t first, std::size_t count) {
    auto& blocks = random.scene.blocks;
    const std::size_t end = std::min(blocks.size(), first + count);
    if (first < towerBlocksOf(random)) throw InputError("a block of the tower, whose code says where it is");
    blocks.erase(blocks.begin() + static_cast<std::ptrdiff_t>(first), blocks.begin() + static_cast<std::ptrdiff_t>(end));
    const auto isDropped = [&](int block) {
      return block >= 0 && static_cast<std::size_t>(block) >= first && static_cast<std::size_t>(block) < end;
    };
    const auto renumber = [&](int& block) {
      if (block >= 0 && static_cast<std::size_t>(block) >= end) block -= static_cast<int>(end - first);
    };
    Scene& scene = random.scene;
    std::erase_if(scene.forces, [&](const UserForce& force) { return isDropped(force.block); });
    std::erase_if(scene.drives, [&](const Drive& drive) { return isDropped(drive.block); });
    std::erase_if(scene.frictionPairs, [&](const FrictionPair& pair) { return isDropped(pair.a) || isDropped(pair.b); });
    for (UserForce& force : scene.forces) renumber(force.block);
    for (Drive& drive : scene.drives) renumber(drive.block);
    for (FrictionPair& pair : scene.frictionPairs) renumber(pair.a), renumber(pair.b);
  }

  bool dropActions() {
    const Scene& scene = best_.random.scene;
    bool changed = !scene.forces.empty() && tries([](RandomScene& random) { random.scene.forces.clear(); });
    changed = (!scene.drives.empty() && tries([](RandomScene& random) { random.scene.drives.clear(); })) || changed;
    changed = (!scene.moves.empty() && tries([](RandomScene& random) { random.scene.moves.clear(); })) || changed;
    return (scene.moves.size() > 1 && tries([](RandomScene& random) { random.scene.moves.pop_back(); })) || changed;
  }

  // One restitution and friction for all, and all blocks free: whole, then one by one.
  bool dropFixtures() {
    const Scene usual;
    bool changed = set<double>([](Scene& s) -> double& { return s.restitution; }, usual.restitution);
    if (best_.random.scene.floorFriction) {
      changed = tries([](RandomScene& random) { random.scene.floorFriction.reset(); }) || changed;
    }
    if (!best_.random.scene.frictionPairs.empty()) {
      changed = tries([](RandomScene& random) { random.scene.frictionPairs.clear(); }) || changed;
    }
    for (std::size_t b = 0; b < best_.random.scene.blocks.size(); ++b) {
      const BlockSpec& block = best_.random.scene.blocks[b];
      if (block.restitution || block.friction) {
        changed = tries([b](RandomScene& random) {
                    random.scene.blocks[b].restitution.reset();
                    random.scene.blocks[b].friction.reset();
                  }) ||
                  changed;
      }
      if (best_.random.scene.blocks[b].fixed) {
        changed = tries([b](RandomScene& random) { random.scene.blocks[b].fixed = false; }) || changed;
      }
    }
    return changed;
  }

  bool stopBlocks() {
    const auto moves = [](const BlockSpec& block) { return !block.velocity.isZero(0.0) || !block.spin.isZero(0.0); };
    const auto& blocks = best_.random.scene.blocks;
    if (std::none_of(blocks.begin(), blocks.end(), moves)) return false;
    if (tries([](RandomScene& random) {
          for (BlockSpec& block : random.scene.blocks) block.velocity = block.spin = Vec3::Zero();
        })) {
      return true;
    }
    bool changed = false;
    for (std::size_t b = 0; b < best_.random.scene.blocks.size(); ++b) {
      for (Vec3 BlockSpec::*motion : {&BlockSpec::velocity, &BlockSpec::spin}) {
        if ((best_.random.scene.blocks[b].*motion).isZero(0.0)) continue;
        changed = tries([&](RandomScene& random) { random.scene.blocks[b].*motion = Vec3::Zero(); }) || changed;
      }
    }
    return changed;
  }

  // Sets a value to a simpler one, where it is not yet.
  template <class Value>
  bool set(Value& (*of)(Scene&), const std::common_type_t<Value>& simple) {
    if (of(best_.random.scene) == simple) return false;
    return tries([&](RandomScene& random) { of(random.scene) = simple; });
  }

  bool simplify() {
    const Scene usual;
    bool changed = set<Sleep>([](Scene& s) -> Sleep& { return s.settings.sleep; }, usual.settings.sleep);
    changed = set<Inertia>([](Scene& s) -> Inertia& { return s.settings.inertia; }, usual.settings.inertia) || changed;
    changed = set<Method>([](Scene& s) -> Method& { return s.settings.method; }, usual.settings.method) || changed;
    changed = set<std::optional<double>>([](Scene& s) -> std::optional<double>& { return s.settings.tolerance_m; },
                                         usual.settings.tolerance_m) ||
              changed;
    changed = set<double>([](Scene& s) -> double& { return s.gravity.tilt_deg; }, 0.0) || changed;
    changed = set<double>([](Scene& s) -> double& { return s.kineticFriction; }, best_.random.scene.staticFriction) || changed;
    if (best_.random.scene.gravity.magnitude > 0.0) {
      changed = set<double>([](Scene& s) -> double& { return s.gravity.magnitude; }, usual.gravity.magnitude) || changed;
    }
    const auto& blocks = best_.random.scene.blocks;
    const bool alike = std::all_of(blocks.begin(), blocks.end(), [&](const auto& block) { return block.mass == blocks[0].mass; });
    if (!alike && towerBlocksOf(best_.random) == 0) {
      changed = tries([](RandomScene& random) {
                  for (BlockSpec& block : random.scene.blocks) block.mass = random.scene.blocks[0].mass;
                }) ||
                changed;
    }
    return changed;
  }

  // To the frame after what has gone wrong by then, else half, or three quarters.
  bool shorten() {
    const double seconds = best_.random.scene.seconds;
    const double frame_s = best_.random.scene.settings.frame_s;
    const double reached = rounded(best_.record.simulated_s + frame_s, 3);
    for (const double shorter : {frame_s, reached, 0.5 * seconds, 0.75 * seconds}) {
      if (shorter > kLeastShare * seconds || shorter < frame_s) continue;
      if (tries([&](RandomScene& random) { random.scene.seconds = rounded(shorter, 3); })) return true;
    }
    return false;
  }

  static void roundBlock(BlockSpec& block, int digits) {
    if (block.row >= 0) return;
    block.centre = rounded(block.centre, digits);
    block.dimensions = rounded(block.dimensions, digits);
    block.velocity = rounded(block.velocity, digits);
    block.spin = rounded(block.spin, digits);
    block.mass = rounded(block.mass, digits);
    block.orientation = orientationOfRotation(rounded(rotationOfOrientation(block.orientation), digits));
  }

  bool roundNumbers() {
    if (rounds_) return false;  // once is enough: no other change makes long numbers
    for (const int digits : {1, 2, 3, 4}) {
      const auto all = [digits](RandomScene& random) {
        for (BlockSpec& block : random.scene.blocks) roundBlock(block, digits);
        Scene& scene = random.scene;
        scene.staticFriction = rounded(scene.staticFriction, digits);
        scene.kineticFriction = std::min(scene.staticFriction, rounded(scene.kineticFriction, digits));
        scene.gravity.magnitude = rounded(scene.gravity.magnitude, digits);
        scene.gravity.tilt_deg = rounded(scene.gravity.tilt_deg, digits);
        scene.gravity.direction_deg = rounded(scene.gravity.direction_deg, digits);
        if (scene.settings.tolerance_m) scene.settings.tolerance_m = rounded(*scene.settings.tolerance_m, digits);
      };
      rounds_ = tries(all);
      if (rounds_) return true;
    }
    rounds_ = true;
    bool changed = false;
    for (std::size_t b = 0; b < best_.random.scene.blocks.size(); ++b) {
      bool done = false;
      for (int digits = 2; digits <= 4 && !done; ++digits) {
        done = tries([&](RandomScene& random) { roundBlock(random.scene.blocks[b], digits); });
      }
      changed = changed || done;
    }
    return changed;
  }

  Shrunk& best_;
  Fault fault_;
  const JudgeFunction& judge_;
  int mostJudged_;
  bool rounds_ = false;
};

}  // namespace

Shrunk shrinkScene(const RandomScene& random, const Record& record, Fault fault, const JudgeFunction& judge, int mostJudged) {
  Shrunk best{random, record};
  Shrinker shrinker(best, fault, judge, mostJudged);
  while (shrinker.round()) {
  }
  return best;
}

}  // namespace springtower
