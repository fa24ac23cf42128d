#include "api/convert.h"
#include "api/world_impl.h"
#include "solver/metrics/penetration.h"
#include "solver/world/engine.h"

#include <springtower/query.h>

namespace springtower::api {
namespace {

const springtower::Simulation& simulationOf(const World& world) {
  return WorldAccess::running(world).simulation;
}

std::vector<Contact> publicContacts(const std::vector<ContactForce>& forces) {
  std::vector<Contact> contacts;
  contacts.reserve(forces.size());
  for (const ContactForce& force : forces) {
    contacts.push_back({static_cast<int>(force.upper), static_cast<int>(force.lower), api::toPublic(force.point),
                        api::toPublic(force.lowerPoint), api::toPublic(force.normal), force.normalForce,
                        api::toPublic(force.frictionForce), force.depth, force.sliding});
  }
  return contacts;
}

}  // namespace

std::vector<Contact> contacts(const World& world) {
  return publicContacts(contactForces(simulationOf(world)));
}

std::vector<Contact> contactsOn(const World& world, int block) {
  const springtower::Simulation& simulation = simulationOf(world);
  return publicContacts(contactForcesOn(simulation, blockId(checkedBlock(block, simulation.model.blockCount()))));
}

Energy energy(const World& world) {
  const springtower::Energy energy = springtower::energy(simulationOf(world));
  return {energy.kinetic, energy.gravity, energy.springs, energy.contacts};
}

Penetration deepestPenetration(const World& world) {
  const springtower::Simulation& simulation = simulationOf(world);
  PenetrationWorkspace workspace;
  const springtower::Penetration deepest =
      maxPenetration(simulation.state.position, simulation.scene.floor, workspace, simulation.model.fixed);
  return {deepest.depth, static_cast<int>(deepest.first), static_cast<int>(deepest.second)};
}

bool isAsleep(const World& world, int block) {
  const springtower::Simulation& simulation = simulationOf(world);
  return simulation.asleep[checkedBlock(block, simulation.model.blockCount())] != 0;
}

bool allAsleep(const World& world) {
  return springtower::allAsleep(simulationOf(world));
}

bool isAtRest(const World& world) {
  return atRest(simulationOf(world));
}

std::vector<int> islandOf(const World& world, int block) {
  const springtower::Simulation& simulation = simulationOf(world);
  const std::size_t b = checkedBlock(block, simulation.model.blockCount());
  const Islands& islands = simulation.engine->memo.islands;
  if (simulation.asleep[b] != 0 || islands.islandOf.empty() || islands.islandOf[b] < 0) return {};
  const auto together = islands.island(static_cast<std::size_t>(islands.islandOf[b]));
  return {together.begin(), together.end()};
}

}  // namespace springtower::api
