#pragma once

#include "core/scene/scene.h"
#include "scenarios/random_draw.h"

namespace springtower {

// What drives keep to.
inline constexpr double kMaxDriveSpeed_m_s = 2.0;
inline constexpr double kMaxDriveSpin_rad_s = 10.0;
inline constexpr double kMaxDriveAmplitude_m = 0.1;
inline constexpr double kMaxDriveFrequency_hz = 10.0;

// What random scenes have beside their blocks. Half of them have none of it, and one restitution and friction for all.

/// Coefficients of friction: none in a tenth, else the static one evenly up to `most`; the kinetic one is smaller in 40 %.
Friction drawFriction(RandomDraw& draw, double most);

/// Restitution of the scene and of single blocks; friction of the floor, of single blocks and of pairs of blocks. Blocks of a
/// tower (row not negative) have no surfaces of their own, as its code cannot say them. Static friction is at most `most`.
void drawSurfaces(RandomDraw& draw, double most, Scene& scene);

/// Makes one to three of its blocks fixed, or drives one of them: along, about the vertical, or to and fro; in space in any
/// direction. Above a floor none is driven downwards, where it would press what lies below it without bounds. The scene has no
/// forces and no moves; one block at least stays free.
void drawFixtures(RandomDraw& draw, Scene& scene);

}  // namespace springtower
