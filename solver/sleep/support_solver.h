#pragma once

#include "solver/world/support_point.h"

#include <span>

namespace springtower {

/// Distributes a load change of a rigid body, a force (N) and a torque (N m), over the points that support it (quasi-static
/// equilibrium by an active-set iteration). Each point is a spring of equal stiffness that only pushes and whose friction is
/// bounded by Coulomb's cone: points that would pull open, those that reach the cone slip, and their load is redistributed to the
/// others, iteration by iteration; no point is closed again. Fills `added` of each point. Returns false if the remaining points
/// cannot hold the body, which then tips, slides or rotates; also without points. `length_m` is a length of the body that scales
/// rotations against translations; `tangentialRatio` the tangential over the normal stiffness of the springs, > 0.
bool redistribute(std::span<SupportPoint> points, const Vec3& force, const Vec3& torque, double length_m, double tangentialRatio);

}  // namespace springtower
