#pragma once

#include "core/state.h"
#include "narrowphase/manifold.h"
#include "solver/law/contact_force.h"

namespace springtower {

/// Hands what a pair's old manifold knew to its renewed one. Points that stay where they were (within `radius`, m) and edges that
/// still cross keep their memory. The normal energy the old points store at `position` is neither raised nor, as far as the new
/// points reach, lost: kept points that a move of the outline has pressed deeper give some back, and what points stored that are
/// gone is shared by those that are new, as if they had all been reached at one depth. So a rolling pair that keeps changing its
/// points neither gains energy nor sinks. Without anything stored a new point starts like any other when it touches.
void keepContactMemory(const ContactView& old, const ParticleArray& position, const ContactLaw& law, double radius,
                       Manifold& fresh);

}  // namespace springtower
