#include "narrowphase/exact/exact_time_of_impact.h"

#include "narrowphase/exact/exact_polynomial.h"
#include "narrowphase/exact/time_of_impact.h"

#include <array>
#include <bit>
#include <cmath>
#include <limits>

namespace springtower {

namespace {

using namespace exact;

// A double is an integer multiple of 2^-1074 below 2^1024, so with the worst common unit a coordinate has 2098 bits and a
// velocity 2100. 34 limbs leave 76 bits free for sums, and products leave more.
constexpr std::size_t kCoordinate = 34;
using Coordinate = Integer<kCoordinate>;
using Linear = Polynomial<1, kCoordinate>;
using Quadratic = Polynomial<2, 2 * kCoordinate>;
using Cubic = Polynomial<3, 3 * kCoordinate>;

struct Dyadic {
  std::int64_t digits;  ///< odd, or 0
  int exponent;
};

Dyadic dyadic(double value) {
  if (value == 0.0) return {0, 0};
  int exponent = 0;
  const auto digits = static_cast<std::int64_t>(std::ldexp(std::frexp(value, &exponent), 53));
  const int zeros = std::countr_zero(static_cast<std::uint64_t>(digits));
  return {digits >> zeros, exponent - 53 + zeros};
}

/// The vertices of a moving polygon, as polynomials per axis.
template <std::size_t Vertices>
struct ExactPolygon {
  std::array<std::array<Linear, 3>, Vertices> position;
  std::array<std::array<Quadratic, 3>, Vertices> turn;  ///< cross product of a vertex and the next one
};

Quadratic product(const Linear& f, const Linear& g) {
  const auto& [f0, f1] = f.coefficients;
  const auto& [g0, g1] = g.coefficients;
  return {{f0 * g0, f0 * g1 + f1 * g0, f1 * g1}};
}

Quadratic difference(const Quadratic& f, const Quadratic& g) {
  return {{f.coefficients[0] - g.coefficients[0], f.coefficients[1] - g.coefficients[1], f.coefficients[2] - g.coefficients[2]}};
}

/// The coordinates of four moving points as integers of one unit. Returns false if one is not finite.
struct ScaledPoints {
  std::array<std::array<Coordinate, 3>, 4> start, end;
};

bool scalePoints(const std::array<const MovingPoint*, 4>& points, ScaledPoints& scaled) {
  int unit = std::numeric_limits<int>::max();
  for (const MovingPoint* point : points)
    for (int axis = 0; axis < 3; ++axis)
      for (const double value : {point->start[axis], point->end[axis]}) {
        if (!std::isfinite(value)) return false;
        if (value != 0.0) unit = std::min(unit, dyadic(value).exponent);
      }
  const auto scale = [unit](double value) -> Coordinate {
    const Dyadic parts = dyadic(value);
    if (parts.digits == 0) return {};
    return shiftedLeft<kCoordinate>(Integer<1>(parts.digits), static_cast<std::uint32_t>(parts.exponent - unit));
  };
  for (std::size_t i = 0; i < 4; ++i)
    for (std::size_t axis = 0; axis < 3; ++axis) {
      scaled.start[i][axis] = scale(points[i]->start[static_cast<int>(axis)]);
      scaled.end[i][axis] = scale(points[i]->end[static_cast<int>(axis)]);
    }
  return true;
}

/// The polygon whose vertex i is point pairs[i].first minus point pairs[i].second.
template <std::size_t Vertices>
void buildPolygon(const ScaledPoints& points, const std::array<std::pair<std::size_t, std::size_t>, Vertices>& pairs,
                  ExactPolygon<Vertices>& polygon) {
  for (std::size_t i = 0; i < Vertices; ++i)
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const auto [head, tail] = pairs[i];
      const Coordinate start = points.start[head][axis] - points.start[tail][axis];
      polygon.position[i][axis] = {{start, points.end[head][axis] - points.end[tail][axis] - start}};
    }
  for (std::size_t i = 0; i < Vertices; ++i)
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const auto& vertex = polygon.position[i];
      const auto& next = polygon.position[(i + 1) % Vertices];
      const std::size_t u = (axis + 1) % 3, v = (axis + 2) % 3;
      polygon.turn[i][axis] = difference(product(vertex[u], next[v]), product(vertex[v], next[u]));
    }
}

/// det(vertex 0, vertex 1, vertex 2). Zero when the polygon and the origin lie in one plane.
template <std::size_t Vertices>
Cubic coplanarityCubic(const ExactPolygon<Vertices>& polygon) {
  Cubic cubic;
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (std::size_t i = 0; i <= 2; ++i)
      for (std::size_t j = 0; j <= 1; ++j)
        cubic.coefficients[i + j] =
            cubic.coefficients[i + j] + polygon.turn[0][axis].coefficients[i] * polygon.position[2][axis].coefficients[j];
  return cubic;
}

/// Whether the polygon contains the origin at a time at which both lie in one plane. Proof for the four cases: (1) polygon with
/// an area: the turns are the signed areas of the triangles it makes with the origin, in every projection that does not flatten
/// it, and all zero in the others; (2) on a line that misses the origin: the turns around it sum to zero, and are not all zero;
/// (3) on a line through the origin: all turns are zero and the coordinates decide; (4) a single point: the same.
template <std::size_t Vertices, class Root>
bool holdsOrigin(const ExactPolygon<Vertices>& polygon, Root& time) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    int sum = 0;
    for (std::size_t i = 0; i < Vertices; ++i) sum += signAtRoot(polygon.position[i][axis], time);
    if (std::abs(sum) == static_cast<int>(Vertices)) return false;
  }
  for (std::size_t axis = 0; axis < 3; ++axis) {
    bool left = false, right = false;
    for (std::size_t i = 0; i < Vertices; ++i) {
      const int sign = signAtRoot(polygon.turn[i][axis], time);
      left |= sign > 0;
      right |= sign < 0;
      if (left && right) return false;
    }
  }
  return true;
}

template <std::size_t Vertices>
TimeOfImpact timeOfImpact(const std::array<const MovingPoint*, 4>& points,
                          const std::array<std::pair<std::size_t, std::size_t>, Vertices>& pairs) {
  ScaledPoints scaled;
  if (!scalePoints(points, scaled)) return {true, 0.0};  // nothing can be excluded
  ExactPolygon<Vertices> polygon;
  buildPolygon(scaled, pairs, polygon);

  TimeOfImpact earliest{false, 1.0};
  const auto tryTime = [&](auto root) {
    if (earliest.hit && magnitudeRoundedDown(root.at.index, root.at.depth) >= earliest.time) return true;
    if (!holdsOrigin(polygon, root)) return false;
    const double time = roundedDown(root);
    earliest = {true, earliest.hit ? std::min(earliest.time, time) : time};
    return true;
  };
  const Cubic cubic = coplanarityCubic(polygon);
  if (cubic.degree() >= 0) {
    visitRoots(cubic, tryTime);
    return earliest;
  }
  const Linear zeroAtStart{{Coordinate(0), Coordinate(1)}};
  visitRoots(zeroAtStart, tryTime);
  for (std::size_t i = 0; i < Vertices; ++i)
    for (std::size_t axis = 0; axis < 3; ++axis) {
      visitRoots(polygon.position[i][axis], tryTime);
      visitRoots(polygon.turn[i][axis], tryTime);
    }
  return earliest;
}

}  // namespace

TimeOfImpact exactPointTriangleTimeOfImpact(const MovingPoint& point, const MovingPoint& a, const MovingPoint& b,
                                            const MovingPoint& c) {
  return timeOfImpact<3>({&point, &a, &b, &c}, {{{1, 0}, {2, 0}, {3, 0}}});
}

TimeOfImpact exactEdgeEdgeTimeOfImpact(const MovingPoint& a, const MovingPoint& b, const MovingPoint& c, const MovingPoint& d) {
  return timeOfImpact<4>({&a, &b, &c, &d}, {{{2, 0}, {3, 0}, {3, 1}, {2, 1}}});
}

}  // namespace springtower
