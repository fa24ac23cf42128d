#pragma once

#include "core/scene/scene.h"

#include <cstddef>

namespace springtower {

/// Standard deviation of the heights of a tower that is called uneven, m.
inline constexpr double kUnevenHeightsSigma_m = 0.0002;
/// Between the towers of a grid whose towers are never to meet, from axis to axis, m.
inline constexpr double kTowerSpacing_m = 0.3;
/// The tilt of gravity at which a tower of 18 rows topples, but does not slide, degrees.
inline constexpr double kTopplingTilt_deg = 14.5;

/// The same scene in which nothing sleeps.
Scene awake(Scene scene);

/// The same scene under gravity that leans by an angle, degrees, towards +x.
Scene leaning(Scene scene, double tilt_deg);

/// The same scene under gravity that swings by an angle, degrees, so many times a second.
Scene swaying(Scene scene, double amplitude_deg, double frequency_hz);

/// The same scene with all blocks higher by a length, m: they fall together.
Scene raised(Scene scene, double by_m);

/// The same tower with every other row, from the second on, heavier by a factor.
Scene withHeavyRows(Scene scene, double factor);

/// The scene's blocks `along` times along x and `across` times along y, `spacing_m` apart. Copies follow one another along y
/// first. Precondition: both are positive.
Scene grid(Scene one, int along, int across, double spacing_m);

/// The scene's blocks so many times, kTowerSpacing_m apart, on the smallest square that holds them; copies follow one another
/// along x first. Precondition: `copies` is positive.
Scene squareOf(Scene one, int copies);

/// Full towers of 18 rows end against end along x: the blocks along it meet those of the next tower with their small faces, so
/// that all is one island. Throws InputError for options that are not allowed.
Scene touchingTowersScene(int towers, const TowerOptions& options = {});

/// Twelve rows, half of them with blocks missing. Throws InputError for options that are not allowed.
Scene towerWithHolesScene(const TowerOptions& options = {});

/// The tilt of gravity by which a tower of so many rows leans a little more than it can stand, degrees. No more than 30: a short
/// tower would slide before.
double collapseTilt_deg(int rows);

/// Six rows, and a block that is shot at them lengthwise at 5 m/s.
Scene shotTowerScene();

/// Two rows that sleep by the time a block hits them, which falls from 21 m for some 2 s.
Scene sleeperHitScene();

/// The number of the middle block of the middle row, which those who pull a block out take. Precondition: the scene is a tower
/// with that block, and its last block lies in the last row.
std::size_t middleBlock(const Scene& tower);

}  // namespace springtower
