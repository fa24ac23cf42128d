#pragma once

#include "core/hand.h"
#include "solver/frame/prepare.h"
#include "solver/hand/grip.h"
#include "solver/world/simulation.h"

#include <vector>

namespace springtower {

/// Steps a frame of a game: the hand holds its block in it, or none. `contacts`: all contact forces at the present state
/// (contactForces); on return those after the frame, which the next one needs. Before the first frame the equilibrium is searched
/// for; returns false, and steps nothing, where `search.goesOn` ended that. Throws DivergenceError.
bool stepPlayed(const Hand& hand, Grip& grip, std::vector<ContactForce>& contacts, Simulation& simulation,
                const PrepareOptions& search = {});

}  // namespace springtower
