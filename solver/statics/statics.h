#pragma once

#include "core/scene/scene.h"
#include "solver/statics/tilt_margin.h"

#include <optional>
#include <string>
#include <vector>

namespace springtower {

/// Whether rigid blocks with Coulomb friction can be in equilibrium: as placed; only after settling until further points touch;
/// or not at all.
enum class Rest { stands, leans, falls };

/// Static analysis of a scene: rigid blocks, the points at which they touch after settling, and the verdict.
struct StaticScene {
  std::vector<FacePair> facings;     ///< of the blocks as placed
  StaticsModel model;                ///< its points are those of the facings, in their order
  Vec3 gravity = -Vec3::UnitZ();     ///< unit, of the scene at time 0
  std::vector<std::size_t> usable;   ///< points that touch: as placed, after settling, or, for a scene that falls, all points
  std::vector<double> settledGap_m;  ///< of each point: as placed, or after settling
  Rest rest = Rest::falls;
  double settlement_m = 0.0;  ///< largest displacement of a block's centre during settlement
};

/// Contacts and verdict of a scene. If the contacts as placed cannot balance its gravity and blocks lie over gaps (of up to half
/// the least height), the blocks settle: of all small motions without overlap and friction, by the one that brings the centres
/// lowest; it is the solution of a linear program whose dual values are the forces. A scene falls if in this motion a block
/// rotates by more than 5 degrees or sinks by more than half a height. Initial velocities and user forces are ignored. Throws
/// InputError when the scene has no gravity.
StaticScene staticScene(const Scene& scene);

/// How far gravity can rotate from that of the scene until equilibrium is lost; negative for a scene that falls (see tiltMargin;
/// then all gaps are taken as closed).
std::optional<StabilityMargin> tiltMargin(const StaticScene& scene, double tolerance_deg = 0.005);

/// The largest tilt from straight down towards one side, degrees (see tiltTowards); empty where there is no equilibrium with
/// gravity straight down.
std::optional<double> tiltTowards(const StaticScene& scene, double direction_deg);

/// The force of one contact: that of `lower` on `upper`.
struct ContactLoad {
  BlockId upper = kFloor;
  BlockId lower = kFloor;
  Vec3 force = Vec3::Zero();  ///< N
  Vec3 place = Vec3::Zero();  ///< m, the centre of pressure; for a contact without load the mean of its points
  double normal_n = 0.0;      ///< N, along the contact's normal
  double frictionUsed =
      0.0;  ///< largest ratio over its points of the tangential force to friction times the normal force, 0 to 1
  std::vector<Vec3> pointForces;  ///< N, on `upper`, at each point of the facing
};

/// The force of each contact, one for each facing. If more than one distribution balances (a block on three others), it is that
/// of least squares: leastSquaresForces. If that fails, at the limit of equilibrium, it is any distribution that balances, and
/// `anyOfMany` is set. Precondition: the scene does not fall.
struct ContactLoads {
  std::vector<ContactLoad> contacts;
  bool anyOfMany = false;
};
ContactLoads contactLoads(const StaticScene& scene);

/// The load on a block.
struct BlockLoad {
  double weight_n = 0.0;
  double above_n = 0.0;                   ///< normal forces of the blocks on it, of least squares
  double leastAbove_n = 0.0;              ///< the minimum over all distributions of forces
  std::optional<double> greatestAbove_n;  ///< and the maximum; empty where it is unbounded
  bool covered = false;                   ///< whether a block lies over it
  bool loose = false;  ///< whether it is covered and nothing touches it from above, so that it can be drawn out freely
  double gap_m = 0.0;  ///< least gap between a covered block and those over it, 0 where they touch
};

/// The load on each block, two linear programs a block. Precondition: the scene does not fall.
std::vector<BlockLoad> blockLoads(const StaticScene& scene, const ContactLoads& loads);

/// Static analysis of a scene without one of its blocks. The others keep their initial placement, so a scene that settled as a
/// whole settles again.
struct Removal {
  Rest rest = Rest::falls;
  std::optional<StabilityMargin> margin;
};
Removal removalOf(const Scene& scene, BlockId block, double tolerance_deg = 0.05);

/// The same for every block, in parallel.
std::vector<Removal> removals(const Scene& scene, double tolerance_deg = 0.05);

/// The largest force along a unit direction, at its centre, at which a block and the whole scene can still be in equilibrium in
/// place, N; infinity if there is no limit. It is an upper bound: with non-associated friction, slip may begin earlier. Empty for
/// a scene that falls.
std::optional<double> pullLimit(const StaticScene& scene, BlockId block, const Vec3& direction);

}  // namespace springtower
