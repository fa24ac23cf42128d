#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <springtower/settings.h>
#include <string>
#include <string_view>
#include <vector>

// Scenes are plain values: build one by hand or by the functions below, change what you like, and make a World of it. Functions
// of this header keep no state: they may be called from any thread, also at the same time. They allocate.

namespace springtower::api {

/// A vector with three components: a place (m), a velocity (m/s), a force (N), a direction.
struct Vec3 {
  double x = 0.0;
  double y = 0.0;
  double z = 0.0;
  bool operator==(const Vec3&) const = default;
};

/// A rotation, from a block's own axes to the world's: w = cos(angle / 2), (x, y, z) = axis * sin(angle / 2). Where one is given
/// it is a unit quaternion, to a part in 1e9.
struct Quaternion {
  double w = 1.0;
  double x = 0.0;
  double y = 0.0;
  double z = 0.0;
  bool operator==(const Quaternion&) const = default;
};

/// Stands for the floor where a contact names its lower partner, and for no block at all.
inline constexpr int kFloor = -1;

/// Coulomb's coefficients of a surface, or of two that touch.
struct Friction {
  double staticFriction = 0.4;   ///< while they stick, 0 to 10
  double kineticFriction = 0.4;  ///< while they slip, 0 to the static one
  bool operator==(const Friction&) const = default;
};

/// The coefficients of two blocks, whatever their surfaces.
struct FrictionPair {
  int a = 0;
  int b = kFloor;
  Friction friction;
};

/// One block as it starts. The defaults are a block of the game, which lies at the origin.
struct Block {
  Vec3 centre;                             ///< m; each within 10 km
  Vec3 dimensions{0.081, 0.0267, 0.0182};  ///< m, along its own x, y, z; 1e-5 to 100 each
  Quaternion orientation;                  ///< from its own axes to the world's; unit
  Vec3 velocity;                           ///< m/s, of its centre; within 1000
  Vec3 spin;                               ///< rad/s, angular velocity in the world's axes; within 1000
  double mass_kg = 0.0196;                 ///< 1e-9 to 1e6
  int row = -1;                            ///< row of the tower from 0, or -1
  int position = 0;                        ///< 1, 2, 3 in its row, or 0
  std::optional<double> restitution = {};  ///< 0 to 1; the scene's if not given
  bool fixed = false;                     ///< never moves, whatever touches it (a shelf, a ramp, a wall); velocity and spin are 0
  std::optional<Friction> friction = {};  ///< of its surface; the scene's if not given
  /// m, displacements of its corners (numbered as in World::corners) from those of its cuboid, along its own axes; see
  /// placeByCorners
  std::optional<std::array<Vec3, 8>> strain_m = {};
};

/// Gives a block the centre, the orientation and the strain that its corners have in these places, m: those of World::corners of
/// a world at rest, of which a world is made that rests as it does. The block's dimensions are those of the undeformed block.
/// Throws InputError for a place that is not finite or farther out than scenes may reach; whether the corners are near a cuboid
/// of these dimensions is what World and checkScene find.
void placeByCorners(Block& block, const std::array<Vec3, 8>& corners);

/// A force, a torque or both on one block over a time, in the world's axes: constant, or changing linearly to what it is at the
/// end. The force acts at the centre (spread over the corners), at one corner or at a point of the block. It acts for exactly its
/// time, which may begin and end within a frame or a step.
struct Force {
  int block = 0;
  int corner = -1;       ///< -1 the centre; else 0 to 7: bit 0, 1, 2 set on the positive side of the block's x, y, z axis
  Vec3 force_n;          ///< N, at the start; within 1e6
  double start_s = 0.0;  ///< s, from here on
  double end_s = 0.0;    ///< s, up to here, not less than start_s
  std::optional<Vec3> point_m = {};          ///< m, instead of a corner: from the block's centre along its own axes, within it
  Vec3 torque_n_m = {};                      ///< N m, at the start; within 1e6
  std::optional<Vec3> forceAtEnd_n = {};     ///< N; without it, the force is constant
  std::optional<Vec3> torqueAtEnd_n_m = {};  ///< N m; without it, the torque is constant
};

/// A prescribed motion of a block over a time, which is fixed otherwise: a velocity, a spin about its centre, an oscillation.
/// Several of one block add up. From its end on the block stays where it has come to.
struct Drive {
  int block = 0;
  Vec3 velocity_m_s = {};     ///< within 1000
  Vec3 spin_rad_s = {};       ///< world axes; within 1000
  Vec3 amplitude_m = {};      ///< displaces by amplitude (1 - cos(2 pi f t)): from rest, to twice this and back; within 100
  double frequency_hz = 0.0;  ///< 0 to 1000; above 0 where there is an amplitude
  double start_s = 0.0;       ///< s, from here on
  double end_s = 1e7;         ///< s, up to here, not less than start_s
};

/// Gravity: a magnitude, tilted from straight down by an angle towards a direction, and perhaps swaying. Who tilts a scene turns
/// gravity; the floor stays.
struct Gravity {
  double magnitude_m_s2 = 9.81;  ///< 0 to 1000
  double tilt_deg = 0.0;         ///< from straight down, within 180
  double direction_deg = 0.0;    ///< towards which side it leans, from +x over +y, within 360
  double sway_deg = 0.0;         ///< amplitude of a sine of time that is added to the tilt, within 180
  double sway_hz = 0.0;          ///< its frequency, 0 to 1000
  bool operator==(const Gravity&) const = default;
};

/// A whole scene: what there is, how it starts, what acts on it, and how it is simulated.
struct Scene {
  std::string name;           ///< in messages
  std::vector<Block> blocks;  ///< 1 to 200000, not all fixed; none inside another or in the floor, but for what blocks at rest
                              ///< overlap (fixed blocks may be inside one another and in the floor)
  std::vector<Force> forces;  ///< that are known beforehand; see inputs.h for others
  std::vector<Drive> drives;  ///< of blocks that are fixed, marked so or not
  Gravity gravity;
  bool floor = true;             ///< whether there is the plane z = 0
  bool plane = false;            ///< all moves in the plane y = 0: centres, velocities and forces have no y component
  double staticFriction = 0.4;   ///< Coulomb's coefficient for contacts that stick, 0 to 10
  double kineticFriction = 0.4;  ///< and for contacts that slide, 0 to the static one
  double restitution = 0.5;      ///< speed at which blocks part over that at which they met, 0 to 1
  std::optional<Friction> floorFriction = {};    ///< of the floor's surface; the scene's if not given
  std::vector<FrictionPair> frictionPairs = {};  ///< in place of the geometric mean of both surfaces; each pair once
  double seconds = 10.0;  ///< s; for how long the scene is meant to be simulated: a proposal, worlds do not read it
  Settings settings;
};

/// A block of a row set off from its nominal place; rows count from 0, positions from 1.
struct BlockOffset {
  int row = 0;
  int position = 1;
  double dx_m = 0.0;
  double dy_m = 0.0;
};

/// A block that is lower than the others of its row, so that it carries little.
struct LooseBlock {
  int row = 0;
  int position = 1;
  double by_m = 0.0003;
};

/// What varies from tower to tower. What is not given is 0, the seed 1; a scene file's own values stay.
struct TowerOptions {
  std::optional<double> heightsSigma_m = {};  ///< standard deviation of the heights, 0 to 0.003; cut off at three of them
  std::optional<double> massSigma_kg = {};    ///< standard deviation of the masses, 0 to 0.0059; cut off at three of them
  std::optional<std::uint64_t> seed = {};     ///< of the heights and masses; equal seeds give equal towers
  std::optional<double> startGap_m = {};      ///< rows start this far apart and drop, 0 to 1
  std::vector<BlockOffset> offsets = {};
  std::vector<LooseBlock> loose = {};
};

/// The full tower of so many rows of three, 1 to 2000. Even rows lie along x, odd ones along y; block 3 r + p - 1 is that of row
/// r (from 0) and position p (from 1). Throws InputError.
Scene towerScene(int rows, const TowerOptions& options = {});

/// A tower from a bit code such as (010)-(111)-(011): rows from the bottom, 1 present, 0 absent, L present and 0.3 mm lower.
/// Throws InputError naming the place of a mistake.
Scene bitCodeScene(std::string_view code, const TowerOptions& options = {});

/// A scene from a TOML file; scenes/annotated.toml of the repository shows every key. Options that are given replace those of the
/// file's tower. Throws InputError naming the file, the place in it, the key, what is expected and what it got; for a file with
/// moves of a scripted hand too, as worlds play none (inputs.h has a hand that you lead).
Scene sceneFromToml(const std::string& path, const TowerOptions& options = {});

/// A scene from what the command line takes: a scenario's name with or without a size ("tower:18", "wall:20x12", "thrown"), a bit
/// code, or the path of a TOML file. Throws InputError, for an unknown name with all that is allowed.
Scene namedScene(const std::string& name, const TowerOptions& options = {});

/// A scenario that namedScene accepts.
struct ScenarioInfo {
  std::string usage;         ///< how it is written, such as "wall:COLUMNSxCOURSES"
  std::string what;          ///< one sentence
  std::string allowedSizes;  ///< such as "1 to 900 columns, 1 to 100 courses"; empty where it has no size
  bool isTower = false;      ///< whether it takes TowerOptions
};

/// All of them, in the order in which they are listed.
std::vector<ScenarioInfo> scenarioList();

/// Checks all that is said above, which a world requires of its scene. Throws InputError naming the block (or both blocks and how
/// deep they overlap) or the number, what is expected and what it got. Costs a sort of all blocks.
void checkScene(const Scene& scene);

}  // namespace springtower::api
