#pragma once

#include "core/state.h"
#include "narrowphase/manifold.h"
#include "solver/law/contact_force.h"

namespace springtower {

/// Transfers the state of a pair's old manifold to its refreshed one. Points that stay in place (within `radius`, m) and edges
/// that still cross keep their state. The normal energy that the old points store at `position` is not raised and, as far as the
/// new points allow, not lost: if kept points became deeper by a shift of the outline, their elastic depth is reduced; the energy
/// of points that are gone is distributed over the new ones, as if all of them had made contact at one depth. So a rolling pair
/// whose points keep changing neither gains energy nor sinks. If nothing was stored, a new point starts at its first contact like
/// any other.
void transferPointState(const ContactView& old, const ParticleArray& position, const ContactLaw& law, double radius,
                        Manifold& fresh);

}  // namespace springtower
