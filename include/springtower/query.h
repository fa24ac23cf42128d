#pragma once

#include <springtower/world.h>
#include <vector>

// What a world is like now. These functions change nothing: many threads may call them while none changes the world. All throw
// InputError for a world that has failed, and those that take a block for a number that is no block's.

namespace springtower::api {

/// One point at which two blocks, or a block and the floor, push each other now.
struct Contact {
  int upper = kFloor;          ///< the block that the forces are on; which of the two is called so is an accident of numbers
  int lower = kFloor;          ///< the other one; kFloor: the floor
  Vec3 point;                  ///< m, where they act on `upper`
  Vec3 lowerPoint;             ///< m, where the reactions act on `lower`; apart from `point` by the penetration, along the normal
  Vec3 normal;                 ///< unit, from lower to upper
  double normalForce_n = 0.0;  ///< greater than 0
  Vec3 frictionForce_n;        ///< on `upper`
  double depth_m = 0.0;        ///< geometric penetration of the point
  bool sliding = false;        ///< whether friction is at its bound
};

/// All of them, pair by pair in an order that is the same each time. Costs an evaluation of all contacts.
std::vector<Contact> contacts(const World& world);

/// Those on one block.
std::vector<Contact> contactsOn(const World& world, int block);

/// Energies, J.
struct Energy {
  double kinetic = 0.0;
  double gravity = 0.0;   ///< against the floor z = 0, with the gravity of the moment
  double springs = 0.0;   ///< of the deformed blocks
  double contacts = 0.0;  ///< of the contacts' springs
  [[nodiscard]] double total() const { return kinetic + gravity + springs + contacts; }
};
Energy energy(const World& world);

/// The deepest overlap of two blocks, or of a block and the floor, from their deformed shapes alone. The depth is never less than
/// the true one, and equal to it for undeformed blocks. Costs a sort of all blocks.
struct Penetration {
  double depth_m = 0.0;  ///< 0 where nothing overlaps; then both blocks are kFloor
  int first = kFloor;
  int second = kFloor;  ///< kFloor: the floor
};
Penetration deepestPenetration(const World& world);

/// Whether a block sleeps.
bool isAsleep(const World& world, int block);

/// Whether all blocks sleep.
bool allAsleep(const World& world);

/// Whether all blocks have been at rest, slow and balanced, for the time that the settings name. It does not depend on whether
/// blocks are put to sleep.
bool isAtRest(const World& world);

/// The blocks that a block was stepped together with, ascending, itself among them: those that it touches directly or through
/// others, the floor and sleepers joining none. As of the last frame in which it was awake; empty where it sleeps, and before the
/// first frame.
std::vector<int> islandOf(const World& world, int block);

}  // namespace springtower::api
