#pragma once

#include "core/scene/scene.h"

#include <vector>

namespace springtower {

/// What a scene asks of its contacts and springs, before anything has moved.
struct LoadEstimate {
  double contactLoad_n = 0.0;  ///< N, largest load of one contact point between blocks: what the tolerance has to bear
  double floorLoad_n = 0.0;    ///< N, largest load of one contact point on the floor
  double blockLoad_n = 0.0;    ///< N, largest load of one of a block's four upright edges
  double swayStiffness_n_m =
      0.0;                   ///< N/m, least contact stiffness at which the scene's tower does not sway over under its own weight
  int layers = 0;            ///< most blocks on top of one another
  double askewFall_m = 0.0;  ///< m, furthest that a block which does not lie flat falls onto what is below it
};

/// Estimates loads from geometry: every block hands its weight and what it bears in equal shares to the highest blocks below it
/// (as if all fell straight down), each share to two of the four corners of an overlap, and more by the lever of tilted gravity.
/// Sway is the buckling of a column under its own weight (Greenhill 1881), whose bending stiffness is that of the overlaps'
/// corners in series with the blocks, with a factor of ten to spare. O(n log n) for scattered scenes.
LoadEstimate estimateLoads(const Scene& scene);

/// Stiffness, N/m, of one contact point between blocks, of one on the floor (which has fewer, as every block of a tower rests on
/// three others), and of a block's upright edge.
struct Stiffness {
  double contact_n_m = 0.0;
  double floor_n_m = 0.0;
  double spring_n_m = 0.0;
};

/// Stiffness that meets a tolerance (m) for these loads. Doubling the tolerance halves it, but never below what keeps a tower
/// from swaying.
Stiffness stiffnessForTolerance(const LoadEstimate& loads, double tolerance_m);

/// Stability with stiffness-proportional dashpots, C = damping time K: largest stable step (s) for an eigenvalue (1/s2) of M^-1
/// K, and largest stable eigenvalue for a step. Semi-implicit Euler needs the largest eigenvalue of M^-1 (dt^2 K + 2 dt C) below
/// 4; Runge-Kutta 4 bears a little more and takes the same. Midpoint grows by (w dt)^4 / 8 a step, so the dashpots must take
/// more: w^2 dt^3 < 4 damping time. `margin` is the share of the step that is used.
double stableStep(Method method, double spectralRadius, double dampingTime_s, double margin);
double stableSpectralRadius(Method method, double step_s, double dampingTime_s, double margin);

/// The depth aimed at in an impact, m, with a tolerance in force: settings.impactDepth tolerances. Tolerances are of what
/// stands; one below the default asks for no harder impacts, which would cost steps in proportion.
double impactDepth_m(const Settings& settings, double tolerance_m, double blockHeight_m);

}  // namespace springtower
