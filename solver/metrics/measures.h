#pragma once

#include "core/ids.h"
#include "core/state.h"

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace springtower {

// Definitions of accuracy: one function for each figure in reports, charts and tests. All are pure functions of the blocks'
// corners; energies and contact forces are in solver/world/simulation.h, penetration in solver/metrics/penetration.h.

// A block has fallen when, relative to the start, its centre is lower by more than this fraction of its least side, has shifted
// sideways by more than this fraction of its middle side, or its rotation exceeds this angle. So a tower that drifts apart has
// fallen, and a block that leans on the floor as well. A block's own axes, and how the scene is turned, do not matter.
inline constexpr double kFallDropInLeastSides = 0.5;
inline constexpr double kFallShiftInMiddleSides = 0.5;
inline constexpr double kFallTurn_deg = 5.0;

/// Why a block counts as fallen.
enum class Fall : std::uint8_t { none, lower, sideways, turned };

/// Whether a scene stands; if not, the first block (lowest number) that has fallen, and why.
struct Standing {
  bool stands = true;
  BlockId block = kFloor;  ///< the fallen block, kFloor when all stand
  Fall fall = Fall::none;
  double amount = 0.0;  ///< m lower or sideways, degrees turned
};

/// The cuboids fitted to all blocks, [blocks].
std::vector<FittedBox> fittedBoxes(const ParticleArray& position);

/// Whether every block stands as it did at the start (see the limits above). `start`: cuboids at the start, [blocks]; `leftOut`:
/// 1 for blocks that do not count because they are held or removed, [blocks] or empty. A position that is not finite counts as
/// fallen.
Standing standing(const BlockModel& model, std::span<const FittedBox> start, const ParticleArray& position,
                  std::span<const std::uint8_t> leftOut = {});

/// One line of text: "block 3 is 9.2 mm lower than at the start"; "all blocks stand" if they do. Blocks count from 0.
std::string describe(const Standing& standing);

/// The start positions with the gaps between rows closed: each block of a row is lowered, without rotation, onto the highest
/// block of the row below whose outline (bounding rectangle) it overlaps, row 0 onto the floor z = 0 if there is one. A tower of
/// rigid blocks reaches this state from any start gap. Blocks outside rows, and blocks with nothing below them, stay in place.
/// `row`: the row of each block or -1, [blocks].
ParticleArray stackedReference(const ParticleArray& start, std::span<const int> row, bool floor);

/// The blocks of the bottom row: those of row 0 if rows are known, else those whose centre at the start is no more than a quarter
/// of a block height above the lowest.
std::vector<BlockId> bottomRow(const BlockModel& model, const ParticleArray& start, std::span<const int> row);

/// Mean reduction of the height of these blocks relative to their undeformed height, m (positive: compressed). The height of a
/// block is its mean edge along the axis that was nearest to the vertical at the start. 0 for no blocks.
double meanRowCompression(const BlockModel& model, const ParticleArray& start, const ParticleArray& position,
                          std::span<const BlockId> blocks);

/// Largest strain of any spring, |length / rest length - 1|.
double maxStrain(const BlockModel& model, const ParticleArray& position);

/// Largest displacement of any corner, m; creep if the reference is the state at rest. Precondition: both have the same number of
/// blocks.
double largestCornerMove(const ParticleArray& reference, const ParticleArray& position);

/// Root mean square of all corner speeds, m/s; jitter when the scene should be at rest. 0 without blocks.
double rootMeanSquareCornerSpeed(const ParticleArray& velocity);

/// Height of the highest block, at the middle of its most upward face, m. 0 without blocks.
double topHeight(const ParticleArray& position);

/// Height of the tower relative to that of rigid blocks, m; negative when it is lower. `closed`: from stackedReference.
double topHeightError(const ParticleArray& closed, const ParticleArray& position);

}  // namespace springtower
