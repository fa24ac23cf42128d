#pragma once

#include "core/ids.h"
#include "core/state.h"

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace springtower {

// What accuracy means: one function for each figure that a report, a chart or a test quotes. All are pure functions of the
// blocks' corners; energies and contact forces stand in solver/world/simulation.h, penetration in solver/metrics/penetration.h.

// A block has fallen when, against the start, its centre is more than this fraction of its height lower, more than this fraction
// of its width aside, or when it is turned by more than this angle. A tower that walks apart has fallen, and so has a block that
// leans on the floor.
inline constexpr double kFallDropInHeights = 0.5;
inline constexpr double kFallShiftInWidths = 0.5;
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

/// The cuboids that fit all blocks, [blocks].
std::vector<FittedBox> fittedBoxes(const ParticleArray& position);

/// Whether every block stands as it did at the start (see the limits above); drop and shift are judged against the block's own
/// height (its third dimension) and width (its second). `start`: cuboids at the start, [blocks]; `leftOut`: 1 for blocks that do
/// not count because they are held or removed, [blocks] or empty. A position that is not finite counts as fallen.
Standing standing(const BlockModel& model, std::span<const FittedBox> start, const ParticleArray& position,
                  std::span<const std::uint8_t> leftOut = {});

/// One line for people: "block 3 is 9.2 mm lower than at the start"; "all blocks stand" when they do. Blocks count from 0.
std::string describe(const Standing& standing);

/// The start positions with the gaps between rows closed: each block of a row is lowered, without turning, onto the highest block
/// of the row below whose outline (bounding rectangle) it overlaps, row 0 onto the floor z = 0 if there is one. This is where a
/// tower of rigid blocks comes to stand, whatever start gap it was dropped from. Blocks outside rows, and blocks with nothing
/// below them, stay where they are. `row`: the row of each block or -1, [blocks].
ParticleArray stackedReference(const ParticleArray& start, std::span<const int> row, bool floor);

/// The blocks of the bottom row: those of row 0 if rows are known, else those whose centre at the start is no more than a quarter
/// of a block height above the lowest.
std::vector<BlockId> bottomRow(const BlockModel& model, const ParticleArray& start, std::span<const int> row);

/// Mean height that these blocks have lost against their undeformed height, m (positive: compressed). The height of a block is
/// its mean edge along that of its axes that was nearest to the vertical at the start. 0 for no blocks.
double meanRowCompression(const BlockModel& model, const ParticleArray& start, const ParticleArray& position,
                          std::span<const BlockId> blocks);

/// Largest strain of any spring, |length / rest length - 1|.
double maxStrain(const BlockModel& model, const ParticleArray& position);

/// Largest distance of any corner from where it was, m; creep when the reference is the state at rest. Precondition: both have
/// the same number of blocks.
double largestCornerMove(const ParticleArray& reference, const ParticleArray& position);

/// Root mean square of all corner speeds, m/s; jitter when the scene should be at rest. 0 without blocks.
double rootMeanSquareCornerSpeed(const ParticleArray& velocity);

/// Height of the highest block: of the middle of the face that looks up most, m. 0 without blocks.
double topHeight(const ParticleArray& position);

/// Height of the tower against what rigid blocks would reach, m; negative when it is lower. `closed`: from stackedReference.
double topHeightError(const ParticleArray& closed, const ParticleArray& position);

}  // namespace springtower
