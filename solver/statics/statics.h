#pragma once

#include "core/scene/scene.h"
#include "solver/statics/tilt_margin.h"

#include <optional>
#include <string>
#include <vector>

namespace springtower {

/// Whether rigid blocks with Coulomb friction can be in equilibrium: as they are placed; only after they lean until something
/// else touches; or not at all.
enum class Rest { stands, leans, falls };

/// A scene seen by statics: rigid blocks, the points at which they touch once settled, and the verdict.
struct StaticScene {
  std::vector<FacePair> facings;     ///< of the blocks as placed
  StaticsModel model;                ///< its points are those of the facings, in their order
  Vec3 gravity = -Vec3::UnitZ();     ///< unit, of the scene at time 0
  std::vector<std::size_t> usable;   ///< points that touch: as placed, after leaning, or for a scene that falls all there are
  std::vector<double> settledGap_m;  ///< of each point: as placed, or after leaning
  Rest rest = Rest::falls;
  double settlement_m = 0.0;  ///< how far the centre of any block moves while leaning
};

/// Contacts and verdict of a scene. Where the contacts as placed cannot bear its gravity and blocks lie over gaps (of up to half
/// the least height), the blocks settle: of all small motions without overlap the one that brings the centres lowest, a linear
/// programme whose prices are the forces; friction is left out of it. A scene whose blocks would turn by more than 5 degrees or
/// sink by more than half a height falls. Forces and motion that the scene starts with are left out. Throws InputError when the
/// scene has no gravity.
StaticScene staticScene(const Scene& scene);

/// How far gravity can turn from the scene's own before it stands no more; negative for a scene that falls (see tiltMargin; then
/// all gaps are taken as closed).
std::optional<StabilityMargin> tiltMargin(const StaticScene& scene, double tolerance_deg = 0.005);

/// The largest tilt from straight down towards one side, degrees (see tiltTowards); nothing where straight down is not borne.
std::optional<double> tiltTowards(const StaticScene& scene, double direction_deg);

/// The force of one contact: what `lower` does to `upper`.
struct ContactLoad {
  BlockId upper = kFloor;
  BlockId lower = kFloor;
  Vec3 force = Vec3::Zero();      ///< N
  Vec3 place = Vec3::Zero();      ///< m, the centre of pressure; the mean of its points for a contact without load
  double normal_n = 0.0;          ///< N, along the contact's normal
  double frictionUsed = 0.0;      ///< largest tangential over friction times normal force of its points, 0 to 1
  std::vector<Vec3> pointForces;  ///< N, on `upper`, at each point of the facing
};

/// Which contact carries how much, one for each facing. Where more than one distribution balances (a block on three others), the
/// one of least squares is given: leastSquaresForces. Where that fails, at the very edge of equilibrium, it is any that balances,
/// and `anyOfMany` is set. Precondition: the scene does not fall.
struct ContactLoads {
  std::vector<ContactLoad> contacts;
  bool anyOfMany = false;
};
ContactLoads contactLoads(const StaticScene& scene);

/// What a block carries.
struct BlockLoad {
  double weight_n = 0.0;
  double above_n = 0.0;                   ///< normal forces of what lies on it, of least squares
  double leastAbove_n = 0.0;              ///< the least that any distribution of forces gives
  std::optional<double> greatestAbove_n;  ///< and the greatest; nothing where it is unbounded
  bool covered = false;                   ///< something lies over it
  bool loose = false;                     ///< it is covered and nothing touches it from above, so it can be drawn out freely
  double gap_m = 0.0;                     ///< the least gap between a covered block and what lies over it, 0 where they touch
};

/// What each block carries, two linear programmes a block. Precondition: the scene does not fall.
std::vector<BlockLoad> blockLoads(const StaticScene& scene, const ContactLoads& loads);

/// What becomes of a scene without one of its blocks. The others stay where they are, so a scene that settled as a whole is
/// settled anew.
struct Removal {
  Rest rest = Rest::falls;
  std::optional<StabilityMargin> margin;
};
Removal removalOf(const Scene& scene, BlockId block, double tolerance_deg = 0.05);

/// The same for every block, on many threads.
std::vector<Removal> removals(const Scene& scene, double tolerance_deg = 0.05);

/// The greatest force along a unit direction, at its centre, under which a block and the whole scene can still stay as they are,
/// N; infinity where nothing limits it. It is an upper bound: friction that is active may give way earlier. Nothing for a scene
/// that falls.
std::optional<double> pullLimit(const StaticScene& scene, BlockId block, const Vec3& direction);

}  // namespace springtower
