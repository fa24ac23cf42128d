#pragma once

#include "core/scene/scene.h"
#include "core/state.h"

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace springtower {

/// A change of a scene under which physics is the same: seen from elsewhere, in other units, with the blocks in another order. A
/// mirror (in the plane x = 0) comes first, then the turn about z, the scale, and the move.
struct SceneChange {
  std::string name;
  double turn_deg = 0.0;  ///< about z
  bool mirrored = false;
  double scale = 1.0;  ///< of lengths; times go by its root, so that gravity stays (Froude)
  Vec3 by = Vec3::Zero();
  double masses = 1.0;      ///< factor of all masses
  std::uint64_t order = 0;  ///< seed of the order of the blocks; 0 as they are
};

/// What every scene has to be the same under: mirrored, turned by 90 degrees and by three angles drawn from `seed`, moved by a
/// kilometre, blocks permuted in two ways drawn from it, ten times as large, masses of a hundredth and a thousand times, and all
/// at once.
std::vector<SceneChange> sceneChanges(std::uint64_t seed);

/// A scene after a change. Block b of it is block `source[b]` of the plain one. Precondition: the scene has no forces, drives,
/// moves and no plane.
struct ChangedScene {
  SceneChange change;
  Scene scene;
  std::vector<std::size_t> source;
};
ChangedScene changed(const Scene& plain, const SceneChange& change);

/// Places of a changed scene's corners (m) where they are in the plain one, [blocks][8].
ParticleArray placesBack(const ChangedScene& changed, const ParticleArray& position);

/// The factor from an energy of the plain scene to that of the changed one.
double energyFactor(const SceneChange& change);

}  // namespace springtower
