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

/// Incremental sort and sweep (Baraff 1992, "Dynamic simulation of non-penetrating rigid bodies"): blocks stay sorted along one
/// axis from call to call, and insertion sort restores the order where boxes changed.
///
/// One sorted list for a whole scene would suit a tower, but in a field of towers each row would be compared with the same row of
/// every other tower. So space is divided into columns along the sweep axis, and the list is sorted by column first. A block
/// belongs to the column that contains its lower corner; columns are squares with a side of the power of two just above the width
/// of the block (a level for each power), so any block that meets another is in one of a few columns near it, for any mixture of
/// sizes.
struct SortAndSweep {
  /// A block in the sorted list, with a copy of its box: one cache line.
  struct Entry {
    std::uint64_t column;         ///< level and index of the column, packed so that columns sort by level, then index
    std::int32_t block;           ///< which block
    std::uint32_t asleep;         ///< 1 asleep, 0 awake
    std::array<double, 3> lower;  ///< m; the two axes across the columns, then the sweep axis
    std::array<double, 3> upper;  ///< m
  };
  /// A non-empty column: order[begin] up to the begin of the next column.
  struct Column {
    std::uint64_t key;
    std::size_t begin;
    double thickest;  ///< m, upper bound of the extent along the sweep axis of its boxes
  };

  std::size_t axis = 2;               ///< the sweep axis: 0 x, 1 y, 2 z
  AlignedVector<Entry> order;         ///< [blocks], sorted by column, lower end along the axis, block
  std::vector<std::size_t> place;     ///< [blocks], index of each block in `order`
  std::vector<Column> columns;        ///< in the order of their keys; the last one is a sentinel
  std::vector<std::int32_t> awake;    ///< blocks awake in the last call, ascending
  std::vector<std::int32_t> renewed;  ///< working space: blocks whose boxes were updated in this call
  /// Working space: what the search of some blocks has found.
  struct Found {
    std::vector<BlockPair> ascending;   ///< pairs found with a < b in ascending order
    std::vector<BlockPair> outOfOrder;  ///< the others
    std::uint64_t tests = 0;            ///< pairs of boxes compared
  };
  std::vector<Found> found;           ///< [parts of the awake blocks]
  std::vector<BlockPair> ascending;   ///< working space: those of all parts
  std::vector<BlockPair> outOfOrder;  ///< working space: those of all parts
};

/// Resets the structure for these boxes; call it when the number of blocks changes or sleeping blocks were moved. The sweep axis
/// is the one along which the boxes are thinnest on average, because the fewest overlap along it: the vertical in towers. It
/// affects the cost only, never the result.
void reset(SortAndSweep& sweep, const SweptBoxes& boxes);

/// Finds all pairs (a < b) of blocks whose boxes overlap or touch and of which at least one is awake, sorted by a, then b;
/// `pairs` is overwritten. The result depends on the boxes and flags only. Returns the number of pairs of boxes compared.
/// `asleep` is [blocks], 1 where a block sleeps. Preconditions: `reset` was called for as many blocks; bounds are finite, lower
/// <= upper, extents under 1e38 m; a block that slept in the last call and still sleeps has the same box. Cost: proportional to
/// the number of awake blocks and their neighbours, plus a scan of the flags, and of the blocks when one of them changes its
/// column; memory is allocated only when the number of pairs exceeds that of all earlier calls.
std::uint64_t findPairs(SortAndSweep& sweep, const SweptBoxes& boxes, std::span<const std::uint8_t> asleep,
                        std::vector<BlockPair>& pairs);

}  // namespace springtower
