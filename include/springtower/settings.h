#pragma once

#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>

/// The public interface of Springtower: what these headers declare, and nothing else, is meant to be used by other projects.
///
/// Units are SI: m, kg, s, N, J, rad; where a number has another unit its name or comment says so (degrees of tilts). The world's
/// z axis points up; the floor is the plane z = 0. Blocks are numbered by `int` from 0 in the order of their scene.
namespace springtower::api {

/// Bad input: a number, a name, a file, or a call that is not allowed now. `what()` is one line that names it and says what is
/// expected and what it got. A call that throws it has changed nothing.
struct InputError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// How a frame is stepped. `implicit` is the method of the engine; most others are there to be compared with it.
enum class Method {
  implicit,           ///< two-step backward differences, one to eight steps a frame, each solved to equilibrium
  implicitEuler,      ///< the same with one step of history: calmer, but it damps a tower's sway
  implicitEigen,      ///< `implicit` with another library's factors; slower
  semiImplicitEuler,  ///< explicit steps, as many as their stability requires
  midpoint,           ///< explicit, second order
  rungeKutta4,        ///< explicit, fourth order
  report,             ///< the impulses of the report of 2003 that the engine goes back to
  rigidPgs,           ///< rigid blocks, sequential impulses
  rigidLcp,           ///< rigid blocks, pivoting; for a few blocks
  xpbd,               ///< rigid blocks, extended position-based dynamics
  automatic           ///< replaced, when a world is made, by the method that is foreseen to take least time
};

/// How the eight corner particles carry a block's mass: exactly as a uniform cuboid, or as eight equal masses (three times the
/// central moments of inertia).
enum class Inertia { cuboid, lumped };

/// Whether blocks at rest are put to sleep: never; by rest and balance; or by the per-frame test of the report of 2003. What
/// sleeps costs nothing and does not move until something wakes it.
enum class Sleep { off, on, report };

/// Everything that may be tuned. The defaults suit towers of wooden blocks of any size: where a unit below is made of h (the
/// least side of any block, m) and g (gravity, m/s2), a number grows with the scene. Each range is checked when a world is made.
struct Settings {
  Method method = Method::implicit;
  Inertia inertia = Inertia::cuboid;
  Sleep sleep = Sleep::on;
  double frame_s = 1.0 / 60.0;  ///< s, 1e-4 to 0.1; what one call of World::step simulates
  /// m, 1e-7 to 1e-2; no resting penetration and no compression of a row above it. A smaller one means stiffer blocks and, for
  /// explicit methods, more steps. Without one it is 0.05 mm for blocks 18.2 mm high, others in proportion.
  std::optional<double> tolerance_m = {};
  int substeps = 0;                       ///< 0 to 100000; steps of a frame of explicit methods; 0 takes them from the tolerance
  bool allowUnstable = false;             ///< allows a tolerance and substeps that do not fit together
  double stabilitySafety = 0.95;          ///< 0.05 to 1; part of the stability limit that an explicit step uses
  double springRatio = 1.0;               ///< 0.01 to 100; stiffness of an upright edge of a block over that of a contact
  double tangentialRatio = 0.8;           ///< 0.01 to 2; tangential over normal stiffness of a contact
  double maxwellRatio = 0.3;              ///< 0 to 2; stiffness of a contact's relaxing branch over its lasting one: damps sway
  double maxwellTime = 1.161;             ///< 1e-3 to 25 sqrt(h / g); relaxation time of that branch
  double stiffnessDamping = 6.965e-4;     ///< 0 to 0.25 sqrt(h / g); dashpot over stiffness: how high a dropped block rebounds
  double impactDepth = 8.0;               ///< 1 to 1000 tolerances; largest penetration aimed at in an impact
  bool continuousTests = true;            ///< finds collisions by continuous tests; off, what comes together goes through
  double sleepSpeed = 2.5e-4;             ///< 0 to 1 sqrt(g h); a block slower than this may be at rest
  double sleepTime = 12.0;                ///< 0 to 1e6 sqrt(h / g); how long it must have been slower before it sleeps
  double sleepImbalance = 2e-5;           ///< 0 to 1 block weights; largest mean force on a block that counts as balanced
  double reportRestitution = 0.1;         ///< 0 to 1; method `report`: restitution of its impulses
  double reportFrictionDrag = 5.0;        ///< 0 to 1000 1/s; method `report`: drag on contact points
  double reportDisableDistance_m = 2e-4;  ///< m, 0 to 1; sleep `report`: a block that travels less in a frame is disabled
  int reportIterations = 10;              ///< 1 to 1000; method `report`: most passes of its collision loop in a step
  int iterations = 1;                     ///< 1 to 1000; rigid methods: passes over the contacts in a step

  bool operator==(const Settings&) const = default;
};

/// Checks every number against its range. Throws InputError naming the setting, what is expected and what it got. Worlds check
/// their scenes; this is to check beforehand. Thread-safe.
void checkSettings(const Settings& settings);

/// A method by its name, as scene files and the command line spell it ("implicit", "rigid-pgs", "auto"). Throws InputError with
/// all names that are allowed. Thread-safe.
Method methodFromName(std::string_view name);

/// The name of a method. Throws InputError for a value that is no method. Thread-safe.
std::string nameOf(Method method);

}  // namespace springtower::api
