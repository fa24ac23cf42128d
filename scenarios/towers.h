#pragma once

#include "core/scene/scene.h"

#include <cstddef>

namespace springtower {

/// Standard deviation of the heights of an uneven tower, m.
inline constexpr double kUnevenHeightsSigma_m = 0.0002;
/// Distance between the axes of the towers of a grid, large enough that they never touch, m.
inline constexpr double kTowerSpacing_m = 0.3;
/// The tilt of gravity at which a tower of 18 rows topples without sliding, degrees.
inline constexpr double kTopplingTilt_deg = 14.5;

/// The same scene without sleep.
Scene awake(Scene scene);

/// The same scene with gravity tilted by an angle, degrees, towards +x.
Scene leaning(Scene scene, double tilt_deg);

/// The same scene with gravity that oscillates with an amplitude, degrees, and a frequency, Hz.
Scene swaying(Scene scene, double amplitude_deg, double frequency_hz);

/// The same scene with all blocks raised by a length, m: they fall together.
Scene raised(Scene scene, double by_m);

/// The same tower with every other row, from the second on, heavier by a factor.
Scene withHeavyRows(Scene scene, double factor);

/// The scene's blocks `along` times along x and `across` times along y, `spacing_m` apart. Copies are in order of y first.
/// Precondition: both are positive.
Scene grid(Scene one, int along, int across, double spacing_m);

/// The scene's blocks `copies` times, kTowerSpacing_m apart, on the smallest square that holds them; copies are in order of x
/// first. Precondition: `copies` is positive.
Scene squareOf(Scene one, int copies);

/// Full towers of 18 rows end against end along x: their lengthwise blocks touch those of the next tower with their small faces,
/// so that everything is one island. Throws InputError for options that are not allowed.
Scene touchingTowersScene(int towers, const TowerOptions& options = {});

/// Twelve rows, half of them with missing blocks. Throws InputError for options that are not allowed.
Scene towerWithHolesScene(const TowerOptions& options = {});

/// A tilt of gravity slightly beyond the limit of a tower of so many rows, degrees. At most 30: a short tower would slide first.
double collapseTilt_deg(int rows);

/// Two rows, and a block that falls on them from 21 m after some 2 s, when they sleep.
Scene sleeperHitScene();

/// The index of the middle block of the middle row, the one that pull scenes pull out. Precondition: the scene is a tower with
/// that block, and its last block is in the last row.
std::size_t middleBlock(const Scene& tower);

}  // namespace springtower
