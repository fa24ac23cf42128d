#pragma once

#include "core/scene/user_force.h"
#include "core/state.h"

namespace springtower {

/// Where a user force acts, m: a corner, a point that moves with the affine part of its block, or the centre. `position`: m,
/// [blocks][8].
Vec3 placeOf(const BlockModel& model, const ParticleArray& position, const UserForce& user);

/// Adds this load of a user force to the forces on the corners of its block (N, [blocks][8]): all of it on a corner, evenly at
/// the centre, at a point with the weights of contacts; a torque as forces that would turn the corners like a rigid body. Net
/// force and torque about the centre are exactly those of the load.
void addUserForce(const BlockModel& model, const ParticleArray& position, const UserForce& user, const Load& load,
                  ParticleArray& force);

}  // namespace springtower
