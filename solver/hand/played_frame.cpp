#include "solver/hand/played_frame.h"

#include "solver/frame/prepare.h"

namespace springtower {

void stepPlayed(const Hand& hand, Grip& grip, std::vector<ContactForce>& contacts, Simulation& simulation) {
  if (hand.block == kFloor) {
    grip = {};
    letGo(simulation);
  } else {
    hold(hand, contacts, grip, simulation);
  }
  prepare(simulation);
  stepFrame(simulation);
  contacts = contactForces(simulation);
}

}  // namespace springtower
