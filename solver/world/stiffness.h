#pragma once

#include "core/scene/scene.h"

#include <vector>

namespace springtower {

/// Loads that determine the stiffness of contacts and springs, before anything has moved.
struct LoadEstimate {
  double contactLoad_n = 0.0;  ///< N, largest load of one contact point between blocks: the one that the tolerance applies to
  double floorLoad_n = 0.0;    ///< N, largest load of one contact point on the floor
  double blockLoad_n = 0.0;    ///< N, largest load of one of a block's four upright edges
  double swayStiffness_n_m =
      0.0;                   ///< N/m, least contact stiffness at which the scene's tower does not buckle under its own weight
  int layers = 0;            ///< most blocks on top of one another
  double askewFall_m = 0.0;  ///< m, largest height from which a block that does not lie flat falls onto what is below it
};

/// Estimates loads from geometry: every block passes its weight and the load on it in equal shares to the highest blocks below it
/// (as if all fell straight down), each share to two of the four corners of an overlap, and more by the lever of tilted gravity.
/// Sway is the buckling of a column under its own weight (Greenhill 1881), with the bending stiffness of the overlaps' corners in
/// series with the blocks and a safety factor of ten. O(n log n) for scattered scenes.
LoadEstimate estimateLoads(const Scene& scene);

/// Stiffness, N/m, of one contact point between blocks, of one on the floor (which has fewer points, as every block of a tower
/// rests on three others), and of a block's upright edge.
struct Stiffness {
  double contact_n_m = 0.0;
  double floor_n_m = 0.0;
  double spring_n_m = 0.0;
};

/// Stiffness that meets a tolerance (m) for these loads. Doubling the tolerance halves it, but never below the one that prevents
/// buckling.
Stiffness stiffnessForTolerance(const LoadEstimate& loads, double tolerance_m);

/// Stability with stiffness-proportional dashpots, C = damping time K: largest stable step (s) for an eigenvalue (1/s2) of M^-1
/// K, and largest stable eigenvalue for a step. Semi-implicit Euler requires the largest eigenvalue of M^-1 (dt^2 K + 2 dt C)
/// below 4; Runge-Kutta 4 is stable a little beyond that, and the same bound is used. Midpoint amplifies by (w dt)^4 / 8 a step,
/// so the dashpots must dissipate more: w^2 dt^3 < 4 damping time. `margin` is the share of the stable step that is used.
double stableStep(Method method, double spectralRadius, double dampingTime_s, double margin);
double stableSpectralRadius(Method method, double step_s, double dampingTime_s, double margin);

/// Target depth of an impact, m, for a tolerance in force: settings.impactDepth tolerances. Tolerances refer to resting
/// contacts; one below the default does not stiffen impacts, as that would cost steps in proportion.
double impactDepth_m(const Settings& settings, double tolerance_m, double blockHeight_m);

}  // namespace springtower
