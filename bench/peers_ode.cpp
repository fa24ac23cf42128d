// The Open Dynamics Engine (ode.org) on a scene of `springtower chart`: see bench/peers.h.
#include "bench/peers.h"

#include <algorithm>
#include <cstdio>
#include <exception>
#include <ode/ode.h>

namespace springtower {
namespace {

struct World {
  dWorldID world;
  dSpaceID space;
  dJointGroupID contacts;
  double friction;
};

void touch(void* data, dGeomID a, dGeomID b) {
  const World& world = *static_cast<World*>(data);
  constexpr int kMost = 8;
  dContact contact[kMost] = {};
  const int count = dCollide(a, b, kMost, &contact[0].geom, sizeof(dContact));
  for (int i = 0; i < count; ++i) {
    contact[i].surface.mode = dContactApprox1;
    contact[i].surface.mu = world.friction;
    dJointAttach(dJointCreateContact(world.world, world.contacts, &contact[i]), dGeomGetBody(a), dGeomGetBody(b));
  }
}

dBodyID addBlock(const World& world, const PeerBlock& block) {
  const dBodyID body = dBodyCreate(world.world);
  const auto& [x, y, z] = block.dimensions;
  dMass mass;
  dMassSetBoxTotal(&mass, block.mass, x, y, z);
  dBodySetMass(body, &mass);
  dBodySetPosition(body, block.centre[0], block.centre[1], block.centre[2]);
  dBodySetQuaternion(body, block.orientation.data());
  dBodySetLinearVel(body, block.velocity[0], block.velocity[1], block.velocity[2]);
  dBodySetAngularVel(body, block.spin[0], block.spin[1], block.spin[2]);
  dGeomSetBody(dCreateBox(world.space, x, y, z), body);
  return body;
}

// All that is not said here is ODE's default; the manual advises QuickStep for large stacks.
int run() {
  const PeerScene scene = readPeerScene();
  dInitODE2(0);
  World world{dWorldCreate(), dHashSpaceCreate(nullptr), dJointGroupCreate(0), scene.friction};
  dWorldSetGravity(world.world, scene.gravity[0], scene.gravity[1], scene.gravity[2]);
  if (scene.iterations > 0) dWorldSetQuickStepNumIterations(world.world, scene.iterations);
  std::vector<dBodyID> bodies;
  for (const PeerBlock& block : scene.blocks) bodies.push_back(addBlock(world, block));
  if (scene.floor) dCreatePlane(world.space, 0, 0, 1, 0);
  const auto stepFrame = [&](const PeerPush& push) {
    for (int i = 0; i < scene.substeps; ++i) {
      dBodyAddForce(bodies[push.block], push.force[0], push.force[1], push.force[2]);
      dSpaceCollide(world.space, &world, touch);
      dWorldQuickStep(world.world, scene.frame_s / scene.substeps);
      dJointGroupEmpty(world.contacts);
    }
  };
  const auto read = [&](std::vector<PeerBlock>& blocks) {
    for (std::size_t b = 0; b < blocks.size(); ++b) {
      std::copy_n(dBodyGetPosition(bodies[b]), 3, blocks[b].centre.begin());
      std::copy_n(dBodyGetQuaternion(bodies[b]), 4, blocks[b].orientation.begin());
      std::copy_n(dBodyGetLinearVel(bodies[b]), 3, blocks[b].velocity.begin());
      std::copy_n(dBodyGetAngularVel(bodies[b]), 3, blocks[b].spin.begin());
    }
  };
  const int code = servePeer(stepFrame, read, scene.blocks);
  dJointGroupDestroy(world.contacts);
  dSpaceDestroy(world.space);
  dWorldDestroy(world.world);
  dCloseODE();
  return code;
}

}  // namespace
}  // namespace springtower

int main() {
  try {
    return springtower::run();
  } catch (const std::exception& error) {
    std::fprintf(stderr, "peers_ode: %s\n", error.what());
    return 2;
  }
}
