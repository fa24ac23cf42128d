#pragma once

#include <cstdint>
#include <utility>
#include <vector>

namespace springtower {

struct Scene;

/// Coulomb's coefficients: of a surface, or of two that touch.
struct Friction {
  double staticFriction = 0.4;   ///< while they stick
  double kineticFriction = 0.4;  ///< while they slip; not above the static one
  bool operator==(const Friction&) const = default;
};

/// The coefficients of two blocks, whatever their surfaces.
struct FrictionPair {
  int a = 0;   ///< counted from 0
  int b = -1;  ///< -1: the floor
  Friction friction;
};

/// The coefficients of every pair of a scene. Two surfaces have the geometric mean of theirs, static and kinetic apart, so one
/// without friction slides on all; pairs of the scene's own go before that.
class FrictionTable {
 public:
  FrictionTable() = default;
  /// Precondition: the scene is checked (checkScene). O(n log n).
  explicit FrictionTable(const Scene& scene);

  /// Of two blocks; -1 is the floor. In either order.
  [[nodiscard]] Friction of(std::int32_t a, std::int32_t b) const { return surfaces_.empty() ? scene_ : ofSurfaces(a, b); }
  /// Whether two blocks have the same surface and none has a pair of its own.
  [[nodiscard]] bool haveSameSurface(std::int32_t a, std::int32_t b) const {
    return surfaces_.empty() || (pairs_.empty() && surfaceOf(a) == surfaceOf(b));
  }

 private:
  [[nodiscard]] Friction ofSurfaces(std::int32_t a, std::int32_t b) const;
  [[nodiscard]] const Friction& surfaceOf(std::int32_t block) const {
    return surfaces_[static_cast<std::size_t>(std::int64_t{block} + 1)];
  }

  Friction scene_;                  // where no other is given
  std::vector<Friction> surfaces_;  // [1 + blocks], the floor first; empty where all have the scene's
  std::vector<std::pair<std::pair<std::int32_t, std::int32_t>, Friction>> pairs_;  // (lesser, greater), ascending
};

}  // namespace springtower
