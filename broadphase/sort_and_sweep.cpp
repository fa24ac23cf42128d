#include "broadphase/sort_and_sweep.h"

#include "core/parallel.h"
#include "core/tuning.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>
#include <cstring>
#include <limits>
#include <numeric>

namespace springtower {
namespace {

using Entry = SortAndSweep::Entry;
using Column = SortAndSweep::Column;

// A column's key: 8 bits of level, 28 bits of index along either axis perpendicular to the columns, all counted from their
// smallest value.
constexpr int kMinLevel = -127;
constexpr int kGreatestLevel = 127;
constexpr int kPlaceBits = 28;
constexpr double kPlaces = 1 << kPlaceBits;

// The computed extent of a box may have been rounded down; enlarged by this factor it is at least the true extent.
constexpr double kRoundUp = 1.0 + 4.0 * std::numeric_limits<double>::epsilon();

// The exponent e of 2^(e-1) <= width < 2^e. The comparison with a power of two is exact even if the width was rounded, so no
// column is missed.
int levelOf(double width) {
  const auto exponent = static_cast<int>(std::bit_cast<std::uint64_t>(width) >> 52);
  return std::clamp(exponent - 1022, kMinLevel, kGreatestLevel);
}

double columnWidth(int level) {
  return std::bit_cast<double>(static_cast<std::uint64_t>(level + 1023) << 52);
}

// Indices beyond the range are clamped, which keeps their order: distant blocks share columns and are distinguished by their
// boxes.
std::uint64_t placeOf(double coordinate, int level) {
  const double place = std::floor(coordinate * columnWidth(-level)) + 0.5 * kPlaces;
  return static_cast<std::uint64_t>(std::clamp(place, 0.0, kPlaces - 1.0));
}

std::uint64_t packKey(int level, std::uint64_t first, std::uint64_t second) {
  return (static_cast<std::uint64_t>(level - kMinLevel) << (2 * kPlaceBits)) | (first << kPlaceBits) | second;
}

int levelIn(std::uint64_t key) {
  return static_cast<int>(key >> (2 * kPlaceBits)) + kMinLevel;
}

std::uint64_t secondPlaceIn(std::uint64_t key) {
  return key & ((std::uint64_t{1} << kPlaceBits) - 1);
}

Entry makeEntry(const SweptBoxes& boxes, std::size_t axis, std::size_t block, std::uint8_t asleep) {
  Entry entry{0, static_cast<std::int32_t>(block), asleep, {}, {}};
  for (std::size_t a = 0; a < 3; ++a) {
    entry.lower[a] = boxes.lower[(axis + 1 + a) % 3][block];
    entry.upper[a] = boxes.upper[(axis + 1 + a) % 3][block];
  }
  const int level = levelOf(std::max(entry.upper[0] - entry.lower[0], entry.upper[1] - entry.lower[1]));
  entry.column = packKey(level, placeOf(entry.lower[0], level), placeOf(entry.lower[1], level));
  return entry;
}

double thickness(const Entry& entry) {
  return (entry.upper[2] - entry.lower[2]) * kRoundUp;
}

bool before(const Entry& a, const Entry& b) {
  if (a.column != b.column) return a.column < b.column;
  if (a.lower[2] != b.lower[2]) return a.lower[2] < b.lower[2];
  return a.block < b.block;
}

bool overlap(const Entry& a, const Entry& b) {
  int all = 1;  // no branches: most entries that are compared overlap along some axes
  for (std::size_t axis = 0; axis < 3; ++axis) {
    all &= static_cast<int>(a.lower[axis] <= b.upper[axis]);
    all &= static_cast<int>(b.lower[axis] <= a.upper[axis]);
  }
  return all != 0;
}

// Moves an entry to the place of its new value in an otherwise sorted order; returns the number of entries shifted.
std::size_t insert(SortAndSweep& sweep, const Entry& entry) {
  auto& order = sweep.order;
  auto& place = sweep.place;
  const std::size_t start = place[static_cast<std::size_t>(entry.block)];
  std::size_t p = start;
  const auto move = [&](std::size_t from) {
    order[p] = order[from];
    place[static_cast<std::size_t>(order[p].block)] = p;
    p = from;
  };
  while (p > 0 && before(entry, order[p - 1])) move(p - 1);
  while (p + 1 < order.size() && before(order[p + 1], entry)) move(p + 1);
  order[p] = entry;
  place[static_cast<std::size_t>(entry.block)] = p;
  return p > start ? p - start : start - p;
}

void sortAll(SortAndSweep& sweep) {
  std::sort(sweep.order.begin(), sweep.order.end(), before);
  for (std::size_t p = 0; p < sweep.order.size(); ++p) sweep.place[static_cast<std::size_t>(sweep.order[p].block)] = p;
}

void listColumns(SortAndSweep& sweep) {
  auto& columns = sweep.columns;
  columns.clear();
  for (std::size_t p = 0; p < sweep.order.size(); ++p) {
    const Entry& entry = sweep.order[p];
    if (columns.empty() || columns.back().key != entry.column) columns.push_back({entry.column, p, 0.0});
    columns.back().thickest = std::max(columns.back().thickest, thickness(entry));
  }
  columns.push_back({std::numeric_limits<std::uint64_t>::max(), sweep.order.size(), 0.0});
}

const Column* findColumn(const Column* from, const Column* end, std::uint64_t key) {
  return std::lower_bound(from, end, key, [](const Column& column, std::uint64_t value) { return column.key < value; });
}

// Calls visit(column) for every column that may contain a block whose box meets this one: those from one column's width below its
// lower corner to its upper corner, on each level.
template <class Visit>
void visitColumns(const SortAndSweep& sweep, const Entry& entry, Visit visit) {
  const Column* column = sweep.columns.data();
  const Column* const end = column + sweep.columns.size() - 1;
  while (column != end) {
    const int level = levelIn(column->key);
    const double width = columnWidth(level);
    const std::uint64_t firstPlace = placeOf(entry.lower[0] - width, level);
    const std::uint64_t secondPlace = placeOf(entry.lower[1] - width, level);
    const std::uint64_t secondEnd = placeOf(entry.upper[1], level);
    const std::uint64_t last = packKey(level, placeOf(entry.upper[0], level), secondEnd);
    column = findColumn(column, end, packKey(level, firstPlace, secondPlace));
    while (column != end && column->key <= last) {
      const std::uint64_t second = secondPlaceIn(column->key);
      if (second < secondPlace) {
        column = findColumn(column, end, column->key - second + secondPlace);
      } else if (second > secondEnd) {
        column = findColumn(column, end, column->key - second + (std::uint64_t{1} << kPlaceBits) + secondPlace);
      } else {
        visit(*column++);
      }
    }
    column = findColumn(column, end, packKey(level + 1, 0, 0));
  }
}

// Updates the boxes of all blocks that are awake now or were in the last call; the latter may have fallen asleep with new boxes.
void update(SortAndSweep& sweep, const SweptBoxes& boxes, std::span<const std::uint8_t> asleep) {
  auto& order = sweep.order;
  bool columnsChanged = sweep.columns.empty();
  // Moving few blocks far or many a little is cheaper than sorting; if everything has moved far it is not.
  constexpr std::size_t kMovesPerBlock = 16;
  const std::size_t mostMoves = kMovesPerBlock * order.size();
  std::size_t moves = 0;
  const auto renew = [&](std::size_t block) {
    const Entry entry = makeEntry(boxes, sweep.axis, block, asleep[block]);
    Entry& old = order[sweep.place[block]];
    columnsChanged |= old.column != entry.column;
    sweep.renewed.push_back(static_cast<std::int32_t>(block));
    if (moves <= mostMoves) {
      moves += insert(sweep, entry);
    } else {
      old = entry;
    }
  };
  sweep.renewed.clear();
  for (const std::int32_t block : sweep.awake) {
    if (asleep[static_cast<std::size_t>(block)] != 0) renew(static_cast<std::size_t>(block));
  }
  sweep.awake.clear();
  const std::uint8_t* const flags = asleep.data();
  const std::uint8_t* const end = flags + asleep.size();
  for (const std::uint8_t* flag = flags; flag != end; ++flag) {
    flag = static_cast<const std::uint8_t*>(std::memchr(flag, 0, static_cast<std::size_t>(end - flag)));
    if (flag == nullptr) break;
    const auto block = static_cast<std::size_t>(flag - flags);
    renew(block);
    sweep.awake.push_back(static_cast<std::int32_t>(block));
  }
  if (moves > mostMoves) sortAll(sweep);
  if (columnsChanged || 2 * sweep.renewed.size() >= order.size()) {
    listColumns(sweep);
    return;
  }
  Column* const columns = sweep.columns.data();
  for (const std::int32_t block : sweep.renewed) {
    const Entry& entry = order[sweep.place[static_cast<std::size_t>(block)]];
    const auto index = findColumn(columns, columns + sweep.columns.size(), entry.column) - columns;
    columns[index].thickest = std::max(columns[index].thickest, thickness(entry));
  }
}

// Finds the pairs of these awake blocks, ascending ones sorted; the others as found.
void findPairsOf(const SortAndSweep& sweep, std::span<const std::int32_t> awake, SortAndSweep::Found& found) {
  found.tests = 0;
  found.ascending.clear();
  found.outOfOrder.clear();
  const Entry* const order = sweep.order.data();
  for (const std::int32_t block : awake) {
    const Entry& entry = order[sweep.place[static_cast<std::size_t>(block)]];
    const std::size_t first = found.ascending.size();
    visitColumns(sweep, entry, [&](const Column& column) {
      const Entry* const begin = order + column.begin;
      const Entry* const end = order + (&column + 1)->begin;
      const double from = entry.lower[2] - column.thickest;
      const Entry* other = std::lower_bound(begin, end, from, [](const Entry& e, double value) { return e.lower[2] < value; });
      for (; other != end && other->lower[2] <= entry.upper[2]; ++other) {
        // Two awake blocks find one another twice; the pair is counted for the first.
        if (other->asleep == 0 && other->block <= block) continue;
        ++found.tests;
        if (!overlap(entry, *other)) continue;
        if (block < other->block) {
          found.ascending.push_back({block, other->block});
        } else {
          found.outOfOrder.push_back({other->block, block});
        }
      }
    });
    std::sort(found.ascending.begin() + static_cast<std::ptrdiff_t>(first), found.ascending.end());
  }
}

}  // namespace

void reset(SortAndSweep& sweep, const SweptBoxes& boxes) {
  const std::size_t count = boxes.blockCount();
  std::array<double, 3> extent{};
  for (std::size_t a = 0; a < 3; ++a) {
    for (std::size_t b = 0; b < count; ++b) extent[a] += boxes.upper[a][b] - boxes.lower[a][b];
  }
  // Among equal axes the last: blocks are stacked along z.
  sweep.axis = 2;
  for (const std::size_t a : {std::size_t{1}, std::size_t{0}}) {
    if (extent[a] < extent[sweep.axis]) sweep.axis = a;
  }
  sweep.order.resize(count);
  sweep.place.resize(count);
  for (std::size_t b = 0; b < count; ++b) sweep.order[b] = makeEntry(boxes, sweep.axis, b, 0);
  sortAll(sweep);
  sweep.columns.clear();
  sweep.columns.reserve(count + 1);
  sweep.renewed.reserve(count);
  // All count as awake until the first call reads the flags.
  sweep.awake.resize(count);
  std::iota(sweep.awake.begin(), sweep.awake.end(), 0);
}

std::uint64_t findPairs(SortAndSweep& sweep, const SweptBoxes& boxes, std::span<const std::uint8_t> asleep,
                        std::vector<BlockPair>& pairs) {
  assert(boxes.blockCount() == sweep.order.size() && asleep.size() == sweep.order.size());
  update(sweep, boxes, asleep);
  // The pairs of parts, one after another, are those of all.
  const std::size_t parts = 1 + sweep.awake.size() / tuning::kSweepPart;
  if (sweep.found.size() < parts) sweep.found.resize(parts);
  const std::size_t size = (sweep.awake.size() + parts - 1) / parts;
  forRanges(parts, 1, parts > 1, [&](std::size_t firstPart, std::size_t lastPart) {
    for (std::size_t part = firstPart; part < lastPart; ++part) {
      const std::size_t first = std::min(part * size, sweep.awake.size());
      findPairsOf(sweep, std::span(sweep.awake).subspan(first, std::min(size, sweep.awake.size() - first)), sweep.found[part]);
    }
  });
  std::uint64_t tests = 0;
  // In many parts the ascending pairs go to the result at once, unless others are to be merged with them.
  const bool inOrder = std::all_of(sweep.found.begin(), sweep.found.begin() + static_cast<std::ptrdiff_t>(parts),
                                   [](const SortAndSweep::Found& found) { return found.outOfOrder.empty(); });
  std::vector<BlockPair>& ascending = parts > 1 && inOrder ? pairs : sweep.ascending;
  ascending.clear();
  sweep.outOfOrder.clear();
  for (std::size_t part = 0; part < parts; ++part) {
    SortAndSweep::Found& found = sweep.found[part];
    tests += found.tests;
    if (parts == 1) {
      ascending.swap(found.ascending);
      found.ascending.reserve(ascending.capacity());  // the two are swapped, so both need the larger capacity
    } else {
      ascending.insert(ascending.end(), found.ascending.begin(), found.ascending.end());
    }
    sweep.outOfOrder.insert(sweep.outOfOrder.end(), found.outOfOrder.begin(), found.outOfOrder.end());
  }
  if (&ascending == &pairs) return tests;
  if (inOrder) {
    pairs.swap(ascending);
    ascending.reserve(pairs.capacity());  // the two are swapped, so both need the larger capacity
    return tests;
  }
  std::sort(sweep.outOfOrder.begin(), sweep.outOfOrder.end());
  pairs.resize(ascending.size() + sweep.outOfOrder.size());
  std::merge(ascending.begin(), ascending.end(), sweep.outOfOrder.begin(), sweep.outOfOrder.end(), pairs.begin());
  return tests;
}

}  // namespace springtower
