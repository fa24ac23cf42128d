#pragma once

#include "solver/statics/linear_program.h"

#include <optional>
#include <vector>

namespace springtower {

/// How far gravity can turn.
struct StabilityMargin {
  double tilt_deg = 0.0;       ///< from the gravity asked about; negative where that cannot be borne
  double direction_deg = 0.0;  ///< towards which side, from +x over +y
};

/// The largest angle by which gravity may turn from `gravity` towards its worst side before no forces at the points `usable` can
/// balance it; or, where they cannot as it is, minus the smallest angle by which it has to turn until they can, and towards which
/// side. Nothing where no turn of less than 89 degrees can be borne.
///
/// The gravities that can be borne are a convex cone; in the plane a unit of gravity away from the blocks they are a convex set,
/// whose extreme point towards any side is one linear programme. The hull of those found is inside the set, their supporting
/// lines outside; the next programme asks along the normal of the hull's edge nearest to the origin, until hull and lines agree
/// within `tolerance_deg` (for an origin outside: the distance algorithm of Gilbert, Johnson & Keerthi 1988). For gravity
/// straight down gravityLimits comes first: a polygon inside those limits and around the circle that the nearest of them touches;
/// where forces parallel to gravity balance at its corners no programme has to be solved. Precondition: `gravity` is unit.
std::optional<StabilityMargin> tiltMargin(const StaticsModel& model, const std::vector<std::size_t>& usable, const Vec3& gravity,
                                          double tolerance_deg = 0.005);

/// The largest angle by which gravity may turn from straight down towards one side, degrees, up to 89; nothing where the points
/// `usable` cannot bear straight down. Directions are from +x over +y.
std::optional<double> tiltTowards(const StaticsModel& model, const std::vector<std::size_t>& usable, double direction_deg);

}  // namespace springtower
