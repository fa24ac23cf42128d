#include "narrowphase/exact/query_set.h"

#include "core/error.h"
#include "core/limits.h"
#include "core/line_input.h"

#include <charconv>
#include <cmath>
#include <fmt/format.h>
#include <string_view>

namespace springtower {

namespace {

constexpr std::size_t kIdColumn = 0, kSetColumn = 1, kHitColumn = 4, kTimeColumn = 5, kDistanceColumn = 6, kFirstCoordinate = 8;
constexpr std::size_t kColumns = kFirstCoordinate + 24;

using Row = std::array<std::string_view, kColumns>;

std::array<std::string, kColumns> columnNames() {
  std::array<std::string, kColumns> names{"id", "set", "src", "family", "gt", "toi", "min_dist", "gt_f32"};
  std::size_t column = kFirstCoordinate;
  for (const char time : {'0', '1'})
    for (const char point : {'a', 'b', 'c', 'd'})
      for (const char axis : {'x', 'y', 'z'}) names[column++] = {point, time, axis};
  return names;
}

/// The file at its current line, for messages.
using Place = LineInput;

[[noreturn]] void fail(const Place& place, const std::string& what) {
  throw InputError(fmt::format("{}: {}", place.where(), what));
}

Row splitRow(const Place& place, std::string_view line) {
  if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
  Row row;
  std::size_t count = 0;
  for (std::size_t from = 0; from <= line.size(); ++count) {
    const std::size_t to = std::min(line.find(',', from), line.size());
    if (count < kColumns) row[count] = line.substr(from, to - from);
    from = to + 1;
  }
  if (count != kColumns) fail(place, fmt::format("expected {} columns, got {}", kColumns, count));
  return row;
}

double readNumber(const Place& place, const std::string& column, std::string_view text, double lowest, double highest) {
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size() || !(value >= lowest && value <= highest))
    fail(place, fmt::format("expected a number from {} to {} in column {}, got {}", lowest, highest, column, inQuotes(text)));
  return value;
}

CollisionQuery readQuery(const Place& place, const Row& row, const std::array<std::string, kColumns>& names) {
  constexpr double kLargest = std::numeric_limits<double>::max();
  CollisionQuery query;
  query.id = row[kIdColumn];
  query.scene = row[kSetColumn];
  if (row[kHitColumn] != "0" && row[kHitColumn] != "1")
    fail(place, fmt::format("expected 0 or 1 in column {}, got {}", names[kHitColumn], inQuotes(row[kHitColumn])));
  const bool hit = row[kHitColumn] == "1";
  if (!hit && !row[kTimeColumn].empty())
    fail(place,
         fmt::format("expected nothing in column {} where gt is 0, got {}", names[kTimeColumn], inQuotes(row[kTimeColumn])));
  query.exact = {hit, hit ? readNumber(place, names[kTimeColumn], row[kTimeColumn], 0.0, 1.0) : 1.0};
  query.smallestDistance = readNumber(place, names[kDistanceColumn], row[kDistanceColumn], 0.0, kLargest);
  std::size_t column = kFirstCoordinate;
  for (Vec3 MovingPoint::*end : {&MovingPoint::start, &MovingPoint::end})
    for (MovingPoint& point : query.points)
      for (int axis = 0; axis < 3; ++axis, ++column)
        (point.*end)[axis] = readNumber(place, names[column], row[column], -kLargest, kLargest);
  return query;
}

}  // namespace

std::vector<CollisionQuery> readCollisionQueries(const std::string& path) {
  LineInput file(path);
  const std::array<std::string, kColumns> names = columnNames();
  std::vector<CollisionQuery> queries;
  std::string line;
  while (file.next(line)) {
    const Row row = splitRow(file, line);
    if (file.number() > 1) {
      queries.push_back(readQuery(file, row, names));
      continue;
    }
    for (std::size_t i = 0; i < kColumns; ++i)
      if (row[i] != names[i])
        fail(file, fmt::format("expected '{}' as name of column {}, got {}", names[i], i + 1, inQuotes(row[i])));
  }
  if (queries.empty())
    throw InputError(fmt::format("{}: expected a header line and at least one query, got no queries", onOneLine(path)));
  return queries;
}

TimeOfImpact answer(const CollisionQuery& query, QueryKind kind, DecidedBy* decidedBy) {
  const auto& [a, b, c, d] = query.points;
  return kind == QueryKind::pointTriangle ? pointTriangleTimeOfImpact(a, b, c, d, decidedBy)
                                          : edgeEdgeTimeOfImpact(a, b, c, d, decidedBy);
}

QueryMistakes judge(const CollisionQuery& query, const TimeOfImpact& answer) {
  const auto& [a, b, c, d] = query.points;
  const bool falseHit = answer.hit && !query.exact.hit;
  return {.missed = query.exact.hit && !answer.hit,
          .late = query.exact.hit && answer.hit && answer.time > std::nextafter(query.exact.time, 2.0),
          .falseHit = falseHit,
          .falseBeyondError = falseHit && query.smallestDistance > kContactError * queryExtent(a, b, c, d)};
}

}  // namespace springtower
