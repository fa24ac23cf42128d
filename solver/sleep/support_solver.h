#pragma once

#include "solver/world/support_point.h"

#include <span>

namespace springtower {

/// Lets the points under a rigid body take up a change of what is done to it: a force (N) and a torque (N m). Each is a spring,
/// all as stiff, that only pushes and whose friction is bounded by Coulomb's cone: points that would pull lift off, those that
/// reach the cone slide, and the others take over what they give up, round after round; none comes back. Fills `added` of each
/// point. Returns false where those that are left cannot hold the body, which then tips, slides or turns; without points as well.
/// `length_m` is a length of the body, by which turns are weighed against moves; `tangentialRatio` the springs' stiffness along
/// the contact over that across it, > 0.
bool redistribute(std::span<SupportPoint> points, const Vec3& force, const Vec3& torque, double length_m, double tangentialRatio);

}  // namespace springtower
