#pragma once

#include "broadphase/swept_boxes.h"
#include "core/ids.h"
#include "core/vector.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace springtower {

/// Sort and sweep (Baraff 1992, "Dynamic simulation of non-penetrating rigid bodies") with a memory: blocks stay sorted along one
/// axis from call to call, and insertion sort repairs the order where boxes changed.
///
/// One sorted list for a whole scene would hold a tower well, but in a field of towers each row would meet the same row of every
/// other tower. So space is cut into columns along the sweep axis, and the list is sorted by column first. A block stands in the
/// column that holds its lower corner; columns are squares of the power of two that is just wider than the block (a level for
/// each power), so whatever meets a block stands in one of a few columns near it, for blocks of any mixture of sizes.
struct SortAndSweep {
  /// A block in the sorted list, with a copy of its box: one cache line.
  struct Entry {
    std::uint64_t column;         ///< level and place of the column, packed so that columns sort by level, then place
    std::int32_t block;           ///< which block
    std::uint32_t asleep;         ///< 1 asleep, 0 awake
    std::array<double, 3> lower;  ///< m; the two axes across the columns, then the sweep axis
    std::array<double, 3> upper;  ///< m
  };
  /// A column that holds blocks: order[begin] up to the begin of the next column.
  struct Column {
    std::uint64_t key;
    std::size_t begin;
    double thickest;  ///< m, at least the extent along the sweep axis of every box in it
  };

  std::size_t axis = 2;               ///< the sweep axis: 0 x, 1 y, 2 z
  AlignedVector<Entry> order;         ///< [blocks], sorted by column, lower end along the axis, block
  std::vector<std::size_t> place;     ///< [blocks], where each block stands in `order`
  std::vector<Column> columns;        ///< in the order of their keys; the last one only ends the list
  std::vector<std::int32_t> awake;    ///< blocks awake in the last call, ascending
  std::vector<std::int32_t> renewed;  ///< working space: blocks whose boxes were taken over in this call
  std::vector<BlockPair> ascending;   ///< working space: pairs found in the order asked for
  std::vector<BlockPair> outOfOrder;  ///< working space: the others
};

/// Starts afresh for these boxes; call it when the number of blocks changes or sleeping blocks were moved. The sweep axis is the
/// one along which the boxes are thinnest on average, as along it the fewest overlap: the vertical in towers. It decides the cost
/// alone, never the result.
void reset(SortAndSweep& sweep, const SweptBoxes& boxes);

/// Finds all pairs (a < b) of blocks whose boxes overlap or touch and of which at least one is awake, sorted by a, then b; what
/// was in `pairs` is lost. The result depends on the boxes and flags alone. Returns the number of pairs of boxes compared.
/// `asleep` is [blocks], 1 where a block sleeps. Preconditions: `reset` was called for as many blocks; bounds are finite, lower
/// <= upper, extents under 1e38 m; a block that slept in the last call and still sleeps has kept its box. Cost: proportional to
/// the blocks awake and their neighbours, beside a scan of the flags, and of the blocks when one of them changes column; memory
/// is allocated only while the number of pairs reaches new heights.
std::uint64_t findPairs(SortAndSweep& sweep, const SweptBoxes& boxes, std::span<const std::uint8_t> asleep,
                        std::vector<BlockPair>& pairs);

}  // namespace springtower
