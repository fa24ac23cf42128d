#pragma once

#include <array>

namespace springtower {

/// A block on its way through explicit steps in which it keeps the shape it has: how it moves, and what its own axes know of its
/// shape. Vectors of the shape are columns, [component][which], and turned all at once.
struct FallingBlock {
  std::array<double, 3> centre{};                               ///< m
  std::array<double, 3> velocity{};                             ///< m/s
  std::array<double, 3> momentum{};                             ///< kg m2/s, angular, about the centre
  std::array<std::array<double, 3>, 3> turn{};                  ///< from its own axes to the world's, rows
  std::array<std::array<double, 3>, 3> inverseMoment{};         ///< 1/(kg m2), own axes
  double inverseMass = 0.0;                                     ///< 1/kg
  alignas(32) std::array<std::array<double, 8>, 3> corner{};    ///< m, from the centre to its corners
  alignas(32) std::array<std::array<double, 12>, 3> vectors{};  ///< mean edges, m; their duals, 1/m; normals (see BlockFrame)
};

}  // namespace springtower
