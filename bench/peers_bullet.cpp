// Bullet (bulletphysics.org) on a scene of `springtower chart`: see bench/peers.h.
#include "bench/peers.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <exception>
#include <memory>

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wconversion"
#pragma GCC diagnostic ignored "-Wshadow"
#include <btBulletDynamicsCommon.h>
#pragma GCC diagnostic pop

namespace springtower {
namespace {

btVector3 vectorOf(const std::array<double, 3>& v, double scale = 1.0) {
  return {static_cast<btScalar>(scale * v[0]), static_cast<btScalar>(scale * v[1]), static_cast<btScalar>(scale * v[2])};
}

std::array<double, 3> arrayOf(const btVector3& v) {
  return {v.x(), v.y(), v.z()};
}

struct Body {
  std::unique_ptr<btBoxShape> shape;
  std::unique_ptr<btDefaultMotionState> motion;
  std::unique_ptr<btRigidBody> body;
};

// All that is not said here is Bullet's default. It multiplies the friction of two bodies.
Body bodyOf(const PeerBlock& block, double friction) {
  Body made;
  made.shape = std::make_unique<btBoxShape>(vectorOf(block.dimensions, 0.5));
  const auto& q = block.orientation;
  const btTransform place(btQuaternion(static_cast<btScalar>(q[1]), static_cast<btScalar>(q[2]), static_cast<btScalar>(q[3]),
                                       static_cast<btScalar>(q[0])),
                          vectorOf(block.centre));
  made.motion = std::make_unique<btDefaultMotionState>(place);
  btVector3 inertia(0, 0, 0);
  const auto mass = static_cast<btScalar>(block.mass);
  if (block.mass > 0.0) made.shape->calculateLocalInertia(mass, inertia);
  btRigidBody::btRigidBodyConstructionInfo info(mass, made.motion.get(), made.shape.get(), inertia);
  info.m_friction = static_cast<btScalar>(std::sqrt(friction));
  made.body = std::make_unique<btRigidBody>(info);
  made.body->setLinearVelocity(vectorOf(block.velocity));
  made.body->setAngularVelocity(vectorOf(block.spin));
  made.body->setActivationState(DISABLE_DEACTIVATION);  // everything stays awake
  return made;
}

// Side of the cube that is the floor, in units: all blocks lie on it, and have as far to go again.
double floorExtent(const PeerScene& scene) {
  double farthest = 25.0;
  for (const PeerBlock& block : scene.blocks)
    farthest = std::max({farthest, std::abs(block.centre[0]), std::abs(block.centre[1])});
  return 4.0 * farthest;
}

int run() {
  const PeerScene scene = readPeerScene();
  btDefaultCollisionConfiguration configuration;
  btCollisionDispatcher dispatcher(&configuration);
  btDbvtBroadphase broadphase;
  btSequentialImpulseConstraintSolver solver;
  btDiscreteDynamicsWorld world(&dispatcher, &broadphase, &solver, &configuration);
  world.setGravity(vectorOf(scene.gravity));
  if (scene.iterations > 0) world.getSolverInfo().m_numIterations = scene.iterations;
  std::vector<Body> bodies;
  for (const PeerBlock& block : scene.blocks) bodies.push_back(bodyOf(block, scene.friction));
  if (scene.floor) {
    const double extent = floorExtent(scene);
    bodies.push_back(bodyOf({{0, 0, -0.5 * extent}, {1, 0, 0, 0}, {}, {}, {extent, extent, extent}, 0.0}, scene.friction));
  }
  for (const Body& made : bodies) world.addRigidBody(made.body.get());
  const auto step_s = static_cast<btScalar>(scene.frame_s / scene.substeps);
  const auto stepFrame = [&](const PeerPush& push) {
    for (int i = 0; i < scene.substeps; ++i) {
      bodies[push.block].body->applyCentralForce(vectorOf(push.force));
      world.stepSimulation(step_s, 0);  // 0: this step, as it is
    }
  };
  const auto read = [&](std::vector<PeerBlock>& blocks) {
    for (std::size_t b = 0; b < blocks.size(); ++b) {
      const btRigidBody& body = *bodies[b].body;
      const btQuaternion q = body.getWorldTransform().getRotation();
      blocks[b].centre = arrayOf(body.getWorldTransform().getOrigin());
      blocks[b].orientation = {q.w(), q.x(), q.y(), q.z()};
      blocks[b].velocity = arrayOf(body.getLinearVelocity());
      blocks[b].spin = arrayOf(body.getAngularVelocity());
    }
  };
  const int code = servePeer(stepFrame, read, scene.blocks);
  for (const Body& made : bodies) world.removeRigidBody(made.body.get());
  return code;
}

}  // namespace
}  // namespace springtower

int main() {
  try {
    return springtower::run();
  } catch (const std::exception& error) {
    std::fprintf(stderr, "peers_bullet: %s\n", error.what());
    return 2;
  }
}
