#pragma once

#include "solver/world/island_step.h"
#include "solver/world/rigid_island.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace springtower {

/// The points of a pair in the step before; `group` is null where there are none.
struct KnownGroup {
  const PointList* list = nullptr;
  const PointGroup* group = nullptr;
  bool isSteady = false;
};

std::span<const ContactConstraint> pointsOf(const KnownGroup& known);

/// Finds pairs in ascending order, from one on, among the points of two lists.
class KnownPoints {
 public:
  KnownPoints(const PointList& steady, const PointList& fast, std::int32_t firstPair);
  /// Precondition: `pair` is none before the last one.
  KnownGroup find(std::int32_t pair);

 private:
  std::array<const PointList*, 2> lists_;
  std::array<std::size_t, 2> at_{};
};

/// Starts the points of a pair with the impulses of the step before: each takes over those of the nearest known point on its
/// upper block within tuning::kPointTakeover, no two of the same. Points have none before.
void warmStartFromKnown(const IslandStep& step, const KnownGroup& known, std::span<ContactConstraint> points);

/// Starts them with the forces that the pair's manifold stores, for substeps of `substep_s`. What the springs of those forces
/// overlap by is not pushed out.
void warmStartFromManifold(const IslandStep& step, const RigidIsland& island, std::size_t at, double substep_s,
                           std::span<ContactConstraint> points);

/// After the last step: the impulses of all points as forces of the manifolds, which are found anew at the present positions;
/// every point that pushes adds its own to the nearest point of its pair's manifold. `substep_s`: in which the impulses acted.
/// Precondition: memo.frames are the present ones.
void storeInManifolds(IslandStep& step, RigidIsland& island, double substep_s);

}  // namespace springtower
