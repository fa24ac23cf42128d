#include "solver/frame/inputs.h"

#include "core/scene/input_check.h"
#include "core/tuning.h"
#include "solver/sleep/rest.h"
#include "solver/world/engine.h"

#include <vector>

namespace springtower {
namespace {

void checkForceOn(const Simulation& simulation, const UserForce& force) {
  checkForce(force, simulation.model.dimensions, "force");
  requireMovable(simulation.scene, static_cast<std::size_t>(force.block), "force: block");
  if (simulation.scene.plane) checkForceInPlane(force, "force");
}

void wakeAll(Simulation& simulation) {
  for (std::size_t b = 0; b < simulation.asleep.size(); ++b) wake(simulation, b, WakeReason::settings);
}

}  // namespace

UserForce forceForOneFrame(const Simulation& simulation, std::size_t block, const Vec3& force) {
  requireBlock(block, simulation.model.blockCount(), "force: block");
  const double end_s = static_cast<double>(simulation.frame + 1) * simulation.scene.settings.frame_s;  // as stepFrame has it
  return {static_cast<int>(block), -1, force, simulation.time_s, end_s};
}

void applyForce(Simulation& simulation, const UserForce& force) {
  checkForceOn(simulation, force);
  const double lastBegin_s = simulation.time_s - simulation.scene.settings.frame_s;
  std::erase_if(simulation.scene.forces, [&](const UserForce& old) { return old.end_s < lastBegin_s; });
  simulation.scene.forces.push_back(force);
}

void setOnlyForce(Simulation& simulation, const UserForce& force) {
  checkForceOn(simulation, force);
  simulation.scene.forces.assign(1, force);
}

void clearForces(Simulation& simulation) {
  simulation.scene.forces.clear();
}

void setGravity(Simulation& simulation, const Gravity& gravity) {
  checkGravity(gravity, "scene");
  if (simulation.scene.plane) checkGravityInPlane(gravity, "scene");
  simulation.scene.gravity = gravity;
}

void setFriction(Simulation& simulation, double staticFriction, double kineticFriction) {
  checkFriction(staticFriction, kineticFriction, "scene");
  simulation.scene.staticFriction = staticFriction;
  simulation.scene.kineticFriction = kineticFriction;
  simulation.friction = FrictionTable(simulation.scene);
  wakeAll(simulation);
}

void setSleep(Simulation& simulation, Sleep sleep) {
  simulation.scene.settings.sleep = sleep;
  wakeAll(simulation);
}

void kick(Simulation& simulation, std::size_t block, const Vec3& velocity) {
  requireBlock(block, simulation.model.blockCount(), "kick: block");
  for (std::size_t c = 0; c < kCorners; ++c) simulation.state.velocity.add(block, c, velocity);
  simulation.engine->memo.blockHistory[block].lastImplicitStep_s = 0.0;
  simulation.engine->memo.islandHistory[block].implicitSteps = tuning::kStepsAfterKick;
  simulation.restTime_s[block] = 0.0;
  wake(simulation, block, WakeReason::kick);
}

}  // namespace springtower
