#pragma once

#include <optional>
#include <springtower/scene.h>
#include <vector>

// Whether a scene can stand at all, from linear programs and not from a simulation: rigid blocks, Coulomb's friction, the
// gravity of time 0. Forces, velocities and spins of the scene are left out. Functions keep no state and may be called from any
// thread; they allocate. All throw InputError for a scene that checkScene refuses, for one without gravity, and for more than
// 1000 blocks.

namespace springtower::api {

/// Stands as placed; stands after its blocks have leant until something else touches; or cannot stand.
enum class Verdict { stands, leans, falls };

/// One linear program, two where blocks have to lean.
Verdict verdict(const Scene& scene);

/// The verdict on the scene without one of its blocks; the others stay where they are. Throws InputError for a number that is no
/// block's and for the only block.
Verdict verdictWithout(const Scene& scene, int block);

/// How far gravity can turn before a scene stands no more.
struct StabilityMargin {
  double tilt_deg = 0.0;       ///< towards the worst side; negative: how far it has to turn until a scene that falls stands
  double direction_deg = 0.0;  ///< that side, from +x over +y
};

/// Within 0.005 degrees; nothing where no turn of less than 89 degrees helps. Some dozens of linear programs at most.
std::optional<StabilityMargin> stabilityMargin(const Scene& scene);

/// The force between two blocks that face each other.
struct StaticContact {
  int upper = kFloor;
  int lower = kFloor;         ///< kFloor: the floor
  Vec3 force_n;               ///< on `upper`
  Vec3 place;                 ///< m, the centre of pressure
  double normal_n = 0.0;      ///< its part along the contact's normal
  double frictionUsed = 0.0;  ///< 0 to 1, largest tangential force over the friction limit, of its points
};

/// What a block carries.
struct BlockLoad {
  double weight_n = 0.0;
  double above_n = 0.0;                        ///< sum of the normal forces of what lies on it, as in Loads::contacts
  double leastAbove_n = 0.0;                   ///< the least that any forces that balance give
  std::optional<double> greatestAbove_n = {};  ///< and the greatest; nothing where they are unbounded
  bool covered = false;                        ///< something lies over it
  bool loose = false;                          ///< it is covered and nothing touches it from above: it can be drawn out freely
  double gap_m = 0.0;                          ///< the least gap between a covered block and what lies over it
};

/// Which contact carries how much. Where more than one set of forces balances, it is the one of least squares; at the very edge
/// of equilibrium it may be any that balances.
struct Loads {
  std::vector<StaticContact> contacts;  ///< one for each pair of faces
  std::vector<BlockLoad> blocks;        ///< [blocks]
  bool anyOfMany = false;               ///< whether the forces are not those of least squares
};

/// Nothing for a scene that falls. Two linear programs a block.
std::optional<Loads> loads(const Scene& scene);

/// The greatest force, N, along a direction (of any length but 0), at a block's centre, under which the scene can still stay as
/// it is: an upper bound of what friction holds. Nothing for a scene that falls; infinity where nothing limits it. Throws
/// InputError for a number that is no block's.
std::optional<double> pullLimit(const Scene& scene, int block, const Vec3& direction);

}  // namespace springtower::api
