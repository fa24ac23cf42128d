#pragma once

#include "core/counters.h"
#include "core/scene/friction.h"
#include "core/scene/scene.h"
#include "core/state.h"
#include "solver/law/block_stiffness.h"
#include "solver/law/tether.h"
#include "solver/law/tolerances.h"
#include "solver/world/wake_reason.h"

#include <cstdint>
#include <memory>
#include <vector>

namespace springtower {

struct Engine;  // the engine's working data: pairs, contacts, islands, workspaces (solver/world/engine.h)

/// A running scene. Plain data that tools may read between frames; changed only by functions: below, solver/frame/inputs.h.
struct Simulation {
  explicit Simulation(const Scene& scene);
  ~Simulation();
  Simulation(Simulation&&) noexcept;
  Simulation& operator=(Simulation&&) noexcept;

  Scene scene;
  BlockModel model;
  Lengths lengths;  ///< the scene's length and time scales
  MotionState state;
  Tether tether;  ///< the hand's springs on its block, as set by the owner of the hand (solver/hand/grip), until it releases the
                  ///< block
  double time_s = 0.0;               ///< simulated time, s
  std::uint64_t frame = 0;           ///< frames done
  double tolerance_m = 0.0;          ///< the tolerance in force: as given, or what the given substeps allow
  double dampingTime_s = 0.0;        ///< s, dashpot over stiffness of springs and contacts
  FrictionTable friction;            ///< of every pair, from the scene
  BlockStiffness stiffness;          ///< of contacts and springs, by block; part of the model
  int fixedSubsteps = 0;             ///< steps of every frame if the user gave them, otherwise 0
  int substeps = 0;                  ///< steps of the last frame (the most over its islands)
  std::vector<std::uint8_t> asleep;  ///< 1 where a block sleeps, [blocks]; a fixed block always does
  std::vector<double> restTime_s;    ///< how long a block has been at rest, s, [blocks]; kept with sleep off as well
  Counters counters;
  StageTimes stageTimes;
  WakeCounts wakes{};  ///< blocks woken, by reason
  std::unique_ptr<Engine> engine;
};

/// Advances a scene by one frame (settings.frame_s). Bitwise the same for any number of threads. Throws DivergenceError in the
/// step in which a position stops being finite or a block turns inside out, and InputError before `prepare`
/// (solver/frame/prepare.h).
void stepFrame(Simulation& simulation);

/// Adds to the velocity of a block (m/s), as an instantaneous impact would, and wakes it. Methods with a history drop it for this
/// block; do not change velocities in `state` without this function. Throws InputError for a number that is no block's.
void kick(Simulation& simulation, std::size_t block, const Vec3& velocity);

/// Whether a block sleeps; the floor, numbered -1, always does.
inline bool sleeps(const Simulation& simulation, std::int32_t block) {
  return block < 0 || simulation.asleep[static_cast<std::size_t>(block)] != 0;
}

/// Whether a block is fixed, so that nothing wakes it; the floor, numbered -1, is.
inline bool isFixed(const Simulation& simulation, std::int32_t block) {
  return block < 0 || simulation.model.isFixed(static_cast<std::size_t>(block));
}

/// Whether a block sleeps and may wake: neither the floor nor a fixed block.
inline bool isSleeper(const Simulation& simulation, std::int32_t block) {
  return sleeps(simulation, block) && !isFixed(simulation, block);
}

/// Whether every block sleeps.
bool allAsleep(const Simulation& simulation);

/// Whether every block has been at rest (speed of its rigid motion, force and torque balance) for the time the settings name.
bool atRest(const Simulation& simulation);

/// Energies, J. The kinetic energy is the one that the leapfrog form of semi-implicit Euler conserves for linear forces: half the
/// product of the velocities before and after the kick of the coming step (Hairer, Lubich & Wanner 2003, Acta Numerica 12), with
/// the inertia in force.
struct Energy {
  double kinetic = 0.0;
  double gravity = 0.0;  ///< relative to the floor z = 0, with the present gravity
  double springs = 0.0;
  double contacts = 0.0;       ///< stored in contact springs: normal, Maxwell branch, friction displacement
  std::vector<double> step_s;  ///< of each block: the step of that kick; 0 where velocity and position belong to the same time
  std::vector<double> stepShare_j_s2;  ///< of each block: correction of its kinetic energy, over the square of the step
  [[nodiscard]] double total() const { return kinetic + gravity + springs + contacts; }
};
Energy energy(const Simulation& simulation);

/// Rise of energy between the ends of two frames, J, both as the later frame's steps conserve it: a frame with shorter steps than
/// the one before is not itself a rise.
double energyRise(const Energy& before, const Energy& after);

/// One contact point at the present state, for reports, overlays and tests: the force on `upper` from `lower` (kFloor: the
/// floor).
struct ContactForce {
  BlockId upper;
  BlockId lower;
  Vec3 point;          ///< m, point of application on `upper`
  Vec3 lowerPoint;     ///< m, point of application of the reaction on `lower`; differs by the penetration, along the normal
  Vec3 normal;         ///< unit, from lower to upper
  double normalForce;  ///< N, >= 0
  Vec3 frictionForce;  ///< N, on `upper`
  double depth;        ///< m, geometric penetration of the point
  bool sliding;
};
std::vector<ContactForce> contactForces(const Simulation& simulation);

/// The static coefficient of friction of a contact's blocks.
inline double staticFrictionOf(const Simulation& simulation, const ContactForce& contact) {
  return simulation.friction.of(static_cast<std::int32_t>(contact.upper), static_cast<std::int32_t>(contact.lower))
      .staticFriction;
}

/// The contact points of one block.
std::vector<ContactForce> contactForcesOn(const Simulation& simulation, BlockId block);

/// A copy of everything that the next frame depends on, inputs (gravity, forces, friction, sleep, hand) included, and its
/// restoration. A restored simulation repeats its future bit for bit.
struct Snapshot;
std::shared_ptr<const Snapshot> takeSnapshot(const Simulation& simulation);
void restoreSnapshot(Simulation& simulation, const Snapshot& snapshot);

/// A hash (FNV-1a, 64 bit) of the bits of positions, velocities, sleep and contact points: equal for equal states, on any thread
/// count.
std::uint64_t stateHash(const Simulation& simulation);

}  // namespace springtower
