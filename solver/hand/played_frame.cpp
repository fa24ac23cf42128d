#include "solver/hand/played_frame.h"

namespace springtower {

bool stepPlayed(const Hand& hand, Grip& grip, std::vector<ContactForce>& contacts, Simulation& simulation,
                const PrepareOptions& search) {
  if (hand.block == kFloor) {
    grip = {};
    letGo(simulation);
  } else {
    hold(hand, contacts, grip, simulation);
  }
  if (prepare(simulation, search).end == PrepareEnd::cancelled) return false;
  stepFrame(simulation);
  contacts = contactForces(simulation);
  return true;
}

}  // namespace springtower
