#pragma once

#include "core/method.h"

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace springtower {

/// How the corner particles carry a block's mass: `cuboid` has exactly the mass and inertia of a uniform cuboid, `lumped` is the
/// report's eight equal masses (three times the central moments).
enum class Inertia { cuboid, lumped };
/// Whether blocks at rest are put to sleep: never, by rest and balance (the default), or by the report's per-frame test (its
/// appendix 2.5).
enum class Sleep { off, on, report };

/// Everything a user may tune, with its unit and reason; limits and descriptions for people stand in settings.cpp
/// (`settingTable`). Lengths, speeds and times of thresholds are multiples of the scene's block height h, sqrt(g h) and sqrt(h /
/// g), so any size of block works unchanged.
struct Settings {
  Method method = Method::implicit;
  Inertia inertia = Inertia::cuboid;
  Sleep sleep = Sleep::on;
  double frame_s = 1.0 / 60.0;  ///< s; one frame of a 60 Hz display
  /// m; no resting penetration and no row compression above it. Where none is given it is in proportion to the blocks
  /// (core/scene/scene.h, toleranceOf); with substeps alone the largest stable stiffness is taken.
  std::optional<double> tolerance_m;
  int substeps = 0;               ///< steps a frame; 0 takes them from the tolerance
  bool allowUnstable = false;     ///< allow a tolerance and substeps that do not fit together
  double stabilitySafety = 0.95;  ///< fraction of the stability limit that is used
  double springRatio = 1.0;       ///< stiffness of an upright edge spring over that of a contact; more where a scene is fast
  double tangentialRatio = 0.8;   ///< tangential over normal contact stiffness; wood's Mindlin ratio is 2(1-nu)/(2-nu), about 0.8
  double maxwellRatio = 0.3;      ///< stiffness of the contact's Maxwell branch over its lasting one; damps a tower's sway
  double maxwellTime = 1.161;     ///< in sqrt(h / g); relaxation time of that branch, 50 ms for the game's blocks
  /// In sqrt(h / g); dashpot over stiffness, of springs and contacts (beta of Rayleigh damping): sets the rebound and damps
  /// vibration. 30 us for the game's blocks.
  double stiffnessDamping = 6.965e-4;
  double impactDepth = 8.0;  ///< largest penetration aimed at in an impact, in tolerances, default ones at least
  bool continuousTests =
      true;  ///< find collisions by the cubic tests; without them none is found but where blocks touch at the start
  double sleepSpeed =
      2.5e-4;  ///< in sqrt(g h); a block slower than this (corner speed of its rigid motion) is a candidate for sleep
  double sleepTime = 12.0;          ///< in sqrt(h / g); how long it must have been at rest
  double sleepImbalance = 2e-5;     ///< in block weights; largest mean force (or torque over h) that does not start a motion
  double reportRestitution = 0.1;   ///< e of the report's impulses (Eq. 2.11)
  double reportFrictionDrag = 5.0;  ///< 1/s; the report's drag on contact points, per unit of particle mass (report 5.7.2)
  double reportDisableDistance_m = 2e-4;  ///< m; the report's threshold on the summed travel of a block's particles (its
                                          ///< appendix 2.5); the report's own number, for blocks of its unit size, scaled by h
  int reportIterations = 10;              ///< most passes of the report's collision loop in a step
  int iterations = 1;                     ///< rigid methods: iterations over the contacts in a substep
};

/// One row of the table of settings: what the user may write, what it means, and what is allowed.
struct SettingRow {
  std::string_view key;
  std::string_view unit;
  std::string_view reason;
  double least;
  double most;
  std::variant<double Settings::*, int Settings::*, bool Settings::*, std::optional<double> Settings::*> member;
};

/// All settings that are numbers or on/off, in the order of `Settings`; the enumerations are read by the functions below.
std::span<const SettingRow> settingTable();

/// A key that a setting had in earlier versions and the one that it has now; scene files may use either, not both.
struct SettingAlias {
  std::string_view formerKey;
  std::string_view key;
};

/// Former keys of settings, at most one for each.
std::span<const SettingAlias> settingAliases();

/// The former key of a setting, empty where its key was never another.
std::string_view formerKeyOf(std::string_view key);

/// The value of a row as a number (0 and 1 for off and on); none where it is left to the scene.
std::optional<double> numberOf(const Settings& settings, const SettingRow& row);

/// Checks every setting against its row. Throws InputError naming the key, what is expected and what it got.
void checkSettings(const Settings& settings, std::string_view source);

/// Names as the command line and scene files spell them; of a method also the name that it has elsewhere: `bdf2`, `bdf2-eigen`
/// and `legacy-2003` for what is written as `implicit`, `implicit-eigen` and `report`. Each throws InputError naming `source`,
/// what is expected and what it got.
Method methodFromName(std::string_view name, std::string_view source);
Inertia inertiaFromName(std::string_view name, std::string_view source);
Sleep sleepFromName(std::string_view name, std::string_view source);
/// Whether methodFromName reads `name` as this method.
bool isNameOf(std::string_view name, Method method);
/// The name that is written, whatever name was read.
std::string_view nameOf(Method method);
std::string_view nameOf(Inertia inertia);
std::string_view nameOf(Sleep sleep);

}  // namespace springtower
