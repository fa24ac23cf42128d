#pragma once

#include "core/scene/scene.h"
#include "core/state.h"
#include "solver/law/block_stiffness.h"
#include "solver/world/load_estimate.h"

#include <cstddef>
#include <vector>

namespace springtower {

/// Stiffness that meets a tolerance (m) for these loads. Doubling the tolerance halves it, but never below the one that prevents
/// buckling.
BlockStiffness stiffnessForTolerance(const LoadEstimate& loads, double tolerance_m);

/// Makes the springs of explicit methods stiff enough for the speeds of a scene: four edges along a block's least side are
/// strained by tuning::kMaxMotionStrain at most where they stop the speed of the scene's fastest corner at its start, and what a
/// fall from its highest centre to the floor adds; not what forces, hands and drives add. Slow scenes keep what their loads need.
/// Implicit and rigid methods do not need it: their blocks take impulses as rigid bodies. `referenceLength_m`: m, of the edges
/// that `edge_n_m` (N/m, [blocks]) is of, as in BlockStiffness.
void stiffenForMotion(const Scene& scene, double referenceLength_m, std::vector<double>& edge_n_m);

/// Whether a block equals the one before it in dimensions, mass and stiffness of its springs, so that what follows from these
/// need not be computed again.
inline bool equalsPrevious(const BlockModel& model, const BlockStiffness& stiffness, std::size_t block) {
  return block > 0 && model.dimensions[block] == model.dimensions[block - 1] && model.mass[block] == model.mass[block - 1] &&
         stiffness.edge_n_m[block] == stiffness.edge_n_m[block - 1];
}

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
