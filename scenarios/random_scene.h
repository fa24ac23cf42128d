#pragma once

#include "core/scene/scene.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace springtower {

/// What a random scene is about: blocks on blocks; planks that lean on boxes; blocks in mid-air above the floor; blocks without
/// floor and gravity; a stack at which something is shot; a hand, or a force, that takes blocks out of a tower.
enum class RandomKind : std::uint8_t { stack, plank, air, space, shot, hand };
inline constexpr std::array kRandomKinds = {RandomKind::stack, RandomKind::plank, RandomKind::air,
                                            RandomKind::space, RandomKind::shot,  RandomKind::hand};
std::string_view nameOf(RandomKind kind);

// What a random scene keeps to.
inline constexpr std::size_t kMinRandomBlocks = 2;
inline constexpr std::size_t kMaxRandomBlocks = 40;
inline constexpr double kMinRandomSide_m = 1e-3;
inline constexpr double kMaxRandomSide_m = 1.0;
inline constexpr double kMaxRandomMassRatio = 1e4;        ///< of any two blocks
inline constexpr double kMaxRandomFriction = 2.0;         ///< static; the kinetic one is no larger
inline constexpr double kMaxRandomSpeed_m_s = 10.0;       ///< of a block's centre
inline constexpr double kMaxRandomGravity_m_s2 = 30.0;    ///< magnitude
inline constexpr double kMinRandomTolerance_m = 1e-6;     ///< where one is given
inline constexpr double kMaxRandomTolerance_m = 1e-3;     ///< likewise
inline constexpr double kMaxRandomToleranceShare = 0.01;  ///< of the scene's least side
inline constexpr double kMaxRandomSeconds = 2.0;          ///< of a scene without moves
inline constexpr double kMaxRandomMoveSeconds = 8.0;      ///< of one with moves
/// The exact contact solver (rigid-lcp) is cubic in the contacts: it has scenes of no more blocks than this.
inline constexpr std::size_t kMaxRandomLcpBlocks = 8;

/// A scene drawn at random, and how to write it down.
struct RandomScene {
  Scene scene;  ///< with moves and forces: all that is done to it
  RandomKind kind = RandomKind::stack;
  std::string towerCode;  ///< its first blocks are the tower of this bit code and these options; empty: there is none
  TowerOptions tower;
};

/// The scene of a seed: sizes, masses, friction, gravity, speeds, method and settings are drawn within the limits above, most of
/// them evenly in their logarithm; then surfaces, fixed and driven blocks (scenarios/random_fixtures.h). checkScene accepts it:
/// where a draw is refused the next of the same stream is taken. The same on every machine.
RandomScene randomScene(std::uint64_t seed);

/// Puts the tower of `towerCode` in the place of the scene's first `towerBlocks` blocks. Throws InputError for a code, options,
/// moves or blocks that do not go together.
void rebuildTower(RandomScene& random, std::size_t towerBlocks);

/// Largest mass over smallest of the blocks that are not fixed. Precondition: there is one.
double massRatioOf(const Scene& scene);

}  // namespace springtower
