#pragma once

#include "solver/statics/linear_program.h"

#include <optional>
#include <vector>

namespace springtower {

/// Largest rotation of gravity.
struct StabilityMargin {
  double tilt_deg = 0.0;       ///< from the given gravity; negative if there is no equilibrium under that
  double direction_deg = 0.0;  ///< side towards which it tilts, from +x over +y
};

/// The largest angle by which gravity may rotate from `gravity` towards its worst side while forces at the points `usable` can
/// still balance it; or, if they cannot balance `gravity` itself, minus the smallest angle by which it has to rotate until they
/// can, with that side. Empty if they balance no gravity within 89 degrees.
///
/// The gravities that can be balanced are a convex cone; in the plane at a unit of gravity from the blocks they are a convex set,
/// whose extreme point in any direction is one linear program. The hull of the extreme points found is inside the set, their
/// supporting lines outside; the next program is for the normal of the hull's edge nearest to the origin, until hull and lines
/// agree within `tolerance_deg` (for an origin outside: the distance algorithm of Gilbert, Johnson & Keerthi 1988). For gravity
/// straight down gravityLimits is evaluated first: it gives a polygon inside those limits and around the circle that touches the
/// nearest of them; if forces parallel to gravity balance at its corners, no program has to be solved. Precondition: `gravity` is
/// unit.
std::optional<StabilityMargin> tiltMargin(const StaticsModel& model, const std::vector<std::size_t>& usable, const Vec3& gravity,
                                          double tolerance_deg = 0.005);

/// The largest angle by which gravity may rotate from straight down towards one side, degrees, up to 89; empty if the points
/// `usable` cannot balance gravity straight down. Directions are from +x over +y.
std::optional<double> tiltTowards(const StaticsModel& model, const std::vector<std::size_t>& usable, double direction_deg);

}  // namespace springtower
