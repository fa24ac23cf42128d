#pragma once

#include "core/block.h"
#include "core/scene/drive.h"
#include "core/scene/friction.h"
#include "core/scene/user_force.h"
#include "core/settings.h"
#include "core/vector.h"

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace springtower {

// The game's block, means of the report's Table 3.1 (whose printed mean width 2.6 is its samples' 2.67 truncated).
inline constexpr double kBlockLength_m = 0.081;
inline constexpr double kBlockWidth_m = 0.0267;
inline constexpr double kBlockHeight_m = 0.0182;
inline constexpr double kBlockMass_kg = 0.0196;
inline constexpr double kStandardGravity_m_s2 = 9.81;
/// Wood on wood, falling flat: 0.4 to 0.6 in textbooks.
inline constexpr double kWoodRestitution = 0.5;
/// The default tolerance for these blocks, m; others have it in proportion to their height.
inline constexpr double kBlockTolerance_m = 5e-5;

/// Places (m) of a block's eight corners, or displacements.
using CornerPlaces = std::array<Vec3, kCorners>;

/// One block as it starts.
struct BlockSpec {
  Vec3 centre = Vec3::Zero();                                       ///< m
  Vec3 dimensions{kBlockLength_m, kBlockWidth_m, kBlockHeight_m};   ///< m, along its own x, y, z
  Eigen::Quaterniond orientation = Eigen::Quaterniond::Identity();  ///< from its own axes to the world's; unit
  Vec3 velocity = Vec3::Zero();                                     ///< m/s, of its centre
  Vec3 spin = Vec3::Zero();                                         ///< rad/s, angular velocity in the world's axes
  double mass = kBlockMass_kg;                                      ///< kg
  int row = -1;                                                     ///< row of the tower from 0, or -1
  int position = 0;                                                 ///< 1, 2, 3 in its row, or 0
  std::optional<double> restitution = {};                           ///< coefficient of restitution; the scene's if not given
  bool fixed = false;  ///< never moves, whatever touches it: a shelf, a ramp, a wall; its mass counts for nothing
  std::optional<Friction> friction = {};  ///< of its surface; the scene's if not given
  /// m, displacements of its corners from those of its cuboid, along its own axes; null: none (see core/scene/corners.h)
  std::shared_ptr<const CornerPlaces> strain = {};
};

/// What a scripted hand does in a move: draws a block of the tower out, lays down or drops the block it holds on a place of the
/// tower, or lays it on the floor beside the tower.
enum class MoveKind : std::uint8_t { take, put, putAside };

/// One move of a scripted sequence (solver/hand/moves.h). Places are those of a bit code: rows from 0, positions from 1.
struct Move {
  MoveKind kind = MoveKind::take;
  int row = 0;                   ///< take: where the block lies; put: where it goes
  int position = 1;              ///< 1, 2, 3
  Vec3 towards = Vec3::UnitX();  ///< take: the level direction it is drawn in, unit, along one of the world's axes
  double speed_m_s = 0.04;       ///< take: how fast it is drawn
  double drop_m = 0.0;           ///< put: the height above its place at which it is let go; 0 lays it down
  double limit_n = 5.0;          ///< N, most force of the hand
  std::optional<double> allowed_m =
      {};  ///< m, how far the move may shift any other block beyond rigid settlement; judged if given
};

/// Gravity: a magnitude, tilted from straight down by an angle towards a direction, and perhaps swaying. Tilting a scene means
/// turning gravity; the floor stays.
struct Gravity {
  double magnitude = kStandardGravity_m_s2;  ///< m/s2
  double tilt_deg = 0.0;                     ///< from straight down
  double direction_deg = 0.0;                ///< towards which side it leans, from +x over +y
  double sway_deg = 0.0;                     ///< amplitude of a sine added to the tilt
  double sway_hz = 0.0;                      ///< its frequency

  /// Acceleration at a time (s), m/s2.
  [[nodiscard]] Vec3 at(double time_s) const;
};

/// A whole scene: what there is, how it starts, what acts on it, and how it is to be simulated.
struct Scene {
  std::string name;
  std::vector<BlockSpec> blocks;
  std::vector<UserForce> forces;
  std::vector<Drive> drives;  ///< of fixed blocks
  std::vector<Move> moves;    ///< one after the other; empty: no moves
  Gravity gravity;
  bool floor = true;             ///< the plane z = 0
  bool plane = false;            ///< all that moves stays in the plane y = 0: a scene of rectangles (see checkScene)
  double staticFriction = 0.4;   ///< Coulomb's coefficient for contacts that stick
  double kineticFriction = 0.4;  ///< and for contacts that slide; equal unless a scene gives two
  /// Speed at which blocks part over that at which they met, of blocks and the floor; two blocks that have their own part by the
  /// geometric mean. Method `report` has its own (Settings::reportRestitution).
  double restitution = kWoodRestitution;
  std::optional<Friction> floorFriction = {};    ///< of the floor's surface; the scene's if not given
  std::vector<FrictionPair> frictionPairs = {};  ///< of two blocks each, in place of those of their surfaces
  double seconds = 10.0;                         ///< s; how long to simulate unless the command line says otherwise
  Settings settings;
};

/// A block of a row set off from its nominal place; rows count from 0, positions from 1.
struct BlockOffset {
  int row = 0;
  int position = 1;
  double dx = 0.0;  ///< m
  double dy = 0.0;  ///< m
};

/// A block that is lower than the others of its row, so that it carries little.
struct LooseBlock {
  int row = 0;
  int position = 1;
  double by = 0.0003;  ///< m lower than the others; for a block the bit code marks L, instead of its 0.3 mm
};

/// What varies from tower to tower, beside its bit code. A number that is not given is 0 (the seed 1), or what the scene file
/// says.
struct TowerOptions {
  std::optional<double> heightsSigma_m = {};  ///< m, standard deviation of the heights; cut off at three of them
  std::optional<double> massSigma_kg = {};    ///< kg, standard deviation of the masses; cut off at three of them
  std::optional<std::uint64_t> seed = {};     ///< of the heights and masses, each with a random stream of its own
  std::optional<double> startGap_m = {};      ///< m; rows start this far apart and drop, the lowest stands on the floor
  std::vector<BlockOffset> offsets = {};
  std::vector<LooseBlock> loose = {};
};

/// The first option that is given, in the words of messages ("a seed"); empty if none is.
std::string_view firstGiven(const TowerOptions& options);

/// The full tower of `rows` rows of three. Throws InputError unless 1 <= rows <= 2000 and the options are within limits.
Scene towerScene(int rows, const TowerOptions& options = {});

/// A tower from a bit code such as (010)-(010)-(011) (report 6.1.1): rows from the bottom, 1 present, 0 absent, L present and 0.3
/// mm lower. Even rows lie along x with positions 1, 2, 3 at y = -0.02715, 0, +0.02715; odd rows along y with positions at x
/// likewise: the block's own x axis is its length, so odd rows are turned a quarter turn about z. All blocks of a row stand at
/// the height of the highest block below, which they touch. The height and mass of a place depend on the seed and the place
/// alone, not on which other blocks are present. Throws InputError naming the place of a typo, an offset or loose block that is
/// absent, and blocks that start inside each other.
Scene bitCodeScene(std::string_view code, const TowerOptions& options = {});

/// A scene from a TOML file; scenes/annotated.toml shows every key. The file may describe a tower, single blocks or both. Options
/// that are given replace those of the file's tower. Throws InputError naming the file, the place in it, the key, what is
/// expected and what it got; options for a file without a tower are an error too.
Scene sceneFromToml(const std::string& path, const TowerOptions& options = {});

/// A scene from what the command line names: `tower:R`, a bit code, or a TOML file. Throws InputError.
Scene sceneFromName(const std::string& name, const TowerOptions& options = {});

/// The height h in which thresholds and the default tolerance are measured, m: the least side of any block. Where heights vary
/// it is that of the lowest, the block that a fault of one size matters most to. Precondition: there is a block.
double blockHeightOf(const Scene& scene);

/// The tolerance of a scene, m: as its settings give it, else kBlockTolerance_m in proportion to blockHeightOf.
/// Precondition: there is a block, or the settings give one.
double toleranceOf(const Scene& scene);

/// Checks the scene's moves as a sequence: a block is taken where there is one and with an empty hand, put where there is none,
/// and all numbers are within limits. Throws InputError naming `source`, the move, what is expected and what it got.
void checkMoves(const Scene& scene, std::string_view source);

/// How deep two blocks of which the thinner has this least side, or a block and the floor, may overlap at the start, m: as deep
/// as blocks that rest do, also where they do at the default tolerance and a smaller one is in force, up to a tenth of that side.
double allowedOverlap_m(const Scene& scene, double side_m);

/// Checks what every scene must obey: values within the limits of core/limits.h and `settingTable`, unit orientations,
/// forces on blocks that exist and are not fixed and at points inside them, moves that can be made (checkMoves), at least one
/// block that is not fixed, no block inside another or in the floor by more than allowedOverlap_m (a fixed block inside another
/// fixed one or in the floor is fine), no corner farther from its place in an undeformed block than a hundredth of the least side
/// or the overlap allowed; fixed blocks have no velocity and no spin, and drives are of fixed blocks; in a plane: blocks whose
/// centres and gravity lie in y = 0, with an axis along y, that neither move nor are pushed out of it. The scenes above have been
/// checked; check again after changing one. Throws InputError naming `source`, the block (or both blocks and how deep they
/// overlap), what is expected and what it got.
void checkScene(const Scene& scene, std::string_view source);

}  // namespace springtower
