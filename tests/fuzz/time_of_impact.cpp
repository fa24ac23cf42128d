// The time of impact in doubles against the exact one, for any coordinates.
#include "narrowphase/exact/time_of_impact.h"

#include "narrowphase/exact/exact_time_of_impact.h"
#include "tests/fuzz/fuzz.h"

#include <array>
#include <cmath>
#include <fmt/format.h>

namespace springtower {
namespace {

using Query = std::array<MovingPoint, 4>;

// One coordinate, by a byte that says how: any bits, small whole numbers, their neighbours, decimals, what an earlier one was.
class Coordinates {
 public:
  explicit Coordinates(Bytes& bytes) : bytes_(bytes), scale_(std::ldexp(1.0, bytes.next<std::int8_t>())) {
    constexpr double kOffsets[] = {0.0, 0.0, 1.0, -1000.0, 1e8, 0x1p60};
    offset_ = kOffsets[bytes.below(6)];
    raw_ = bytes.below(4) == 0;
  }

  double next() {
    const int kind = bytes_.below(8);
    if (kind == 7 && raw_) return last_ = bytes_.next<double>();
    if (kind == 6) return last_;
    const double whole = bytes_.below(9) - 4;
    double value = whole;
    if (kind == 1) value = std::nextafter(whole, 10.0);
    if (kind == 2) value = std::nextafter(whole, -10.0);
    if (kind == 3) value = whole / 8.0;
    if (kind >= 4) value = bytes_.between(-4.0, 4.0);
    return last_ = scale_ * (value + offset_);
  }

 private:
  Bytes& bytes_;
  double scale_;
  double offset_ = 0.0;
  bool raw_ = false;
  double last_ = 0.0;
};

Query queryOf(Bytes& bytes) {
  Coordinates coordinates(bytes);
  Query query;
  const int rest = bytes.below(16);  // bits: points that stay where they are
  for (std::size_t p = 0; p < query.size(); ++p) {
    for (int axis = 0; axis < 3; ++axis) query[p].start[axis] = coordinates.next();
    query[p].end = query[p].start;
    if ((rest >> p & 1) != 0) continue;
    for (int axis = 0; axis < 3; ++axis) query[p].end[axis] = coordinates.next();
  }
  return query;
}

std::string described(const Query& query) {
  std::string text;
  for (const MovingPoint& point : query)
    text += fmt::format("({:a} {:a} {:a} -> {:a} {:a} {:a}) ", point.start.x(), point.start.y(), point.start.z(), point.end.x(),
                        point.end.y(), point.end.z());
  return text;
}

bool allFinite(const Query& query) {
  for (const MovingPoint& point : query)
    if (!point.start.allFinite() || !point.end.allFinite()) return false;
  return true;
}

// The most that the difference of two points changes by in one coordinate.
double motionOf(const Query& query) {
  double most = 0.0;
  for (const MovingPoint& a : query)
    for (const MovingPoint& b : query) most = std::max(most, ((a.end - b.end) - (a.start - b.start)).cwiseAbs().maxCoeff());
  return most;
}

void compare(const Query& query, const TimeOfImpact& fast, const TimeOfImpact& exact, std::string_view kind) {
  const auto fail = [&](std::string_view what) {
    requireThat(false, fmt::format("{}: {}; found {} at {:a}, exact {} at {:a}: {}", kind, what, fast.hit, fast.time, exact.hit,
                                   exact.time, described(query)));
  };
  if (fast.hit != exact.hit) fail("a hit is one, a miss none");
  if (!fast.hit && fast.time != 1.0) fail("the time of a miss is 1");
  if (!(fast.time >= 0.0 && fast.time <= 1.0)) fail("the time is within the step");
  if (fast.time > exact.time) fail("never late");
  const auto& [a, b, c, d] = query;
  const double early = (exact.time - fast.time) * motionOf(query);
  constexpr double kSlack = 4.0;  // the stated error holds for the features' distance, of which this is a bound
  if (std::isfinite(early) && early > kSlack * kContactError * queryExtent(a, b, c, d)) fail("early by the stated error at most");
}

void test(const Query& query) {
  const auto& [a, b, c, d] = query;
  const TimeOfImpact point = pointTriangleTimeOfImpact(a, b, c, d);
  const TimeOfImpact edges = edgeEdgeTimeOfImpact(a, b, c, d);
  if (!allFinite(query)) {
    for (const TimeOfImpact& found : {point, edges})
      requireThat(found.hit && found.time == 0.0, "what is not finite is a hit at 0: " + described(query));
    return;
  }
  compare(query, point, exactPointTriangleTimeOfImpact(a, b, c, d), "point and triangle");
  compare(query, edges, exactEdgeEdgeTimeOfImpact(a, b, c, d), "edges");
  requireThat(pointTriangleTimeOfImpact(a, c, d, b).hit == point.hit,
              "the order of corners does not matter: " + described(query));
  requireThat(edgeEdgeTimeOfImpact(c, d, b, a).hit == edges.hit, "the order of edges does not matter: " + described(query));
}

}  // namespace
}  // namespace springtower

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  springtower::Bytes bytes(data, size);
  springtower::test(springtower::queryOf(bytes));
  return 0;
}
