#include "narrowphase/exact/time_of_impact.h"

#include "narrowphase/exact/exact_time_of_impact.h"

#include <array>
#include <limits>

namespace springtower {

namespace {

constexpr double kEpsilon = std::numeric_limits<double>::epsilon();

/// Added to every error bound: more than the effect of underflow where all factors are below 1e100.
constexpr double kUnderflow = 1e-200;

/// Products of six coordinates up to this, and a few of them added, are finite.
constexpr double kLargest = 1e50;

/// Parts of the step examined before exact arithmetic. A simple crossing needs about five.
constexpr int kMaxParts = 24;

/// The differences of two features, as a convex planar polygon whose vertices move in straight lines: triangle minus point, or
/// edge minus edge (a parallelogram). The features share a point when it contains the origin.
template <int Vertices>
struct MovingPolygon {
  std::array<Vec3, Vertices> start, end;
  double size;    ///< no coordinate of a vertex is larger
  double motion;  ///< no coordinate of a vertex changes by more
};

template <int Vertices>
MovingPolygon<Vertices> differences(const std::array<const MovingPoint*, Vertices>& heads,
                                    const std::array<const MovingPoint*, Vertices>& tails) {
  MovingPolygon<Vertices> polygon;
  Vec3 size = Vec3::Zero(), motion = Vec3::Zero();
  for (std::size_t i = 0; i < Vertices; ++i) {
    polygon.start[i] = heads[i]->start - tails[i]->start;
    polygon.end[i] = heads[i]->end - tails[i]->end;
    size = size.cwiseMax(polygon.start[i].cwiseAbs()).cwiseMax(polygon.end[i].cwiseAbs());
    motion = motion.cwiseMax((polygon.end[i] - polygon.start[i]).cwiseAbs());
  }
  polygon.size = size.maxCoeff();
  polygon.motion = motion.maxCoeff();
  return polygon;
}

/// A polygon's vertices at the two ends of a part of the step. Each coordinate has an error of at most `error`.
template <int Vertices>
struct PolygonPart {
  std::array<Vec3, Vertices> from, to;
  double error;
};

template <int Vertices>
PolygonPart<Vertices> partOf(const MovingPolygon<Vertices>& polygon, const TimeInterval& time) {
  PolygonPart<Vertices> part;
  for (std::size_t i = 0; i < Vertices; ++i) {
    part.from[i] = (1.0 - time.from) * polygon.start[i] + time.from * polygon.end[i];
    part.to[i] = (1.0 - time.to) * polygon.start[i] + time.to * polygon.end[i];
  }
  part.error = 2.0 * kEpsilon * polygon.size;  // one rounding of the difference, three of the mean: half a kEpsilon each
  return part;
}

template <int Vertices>
BernsteinCubic coplanarityCubic(const PolygonPart<Vertices>& part) {
  return determinantCubic(part.from[0], part.from[1], part.from[2], part.to[0], part.to[1], part.to[2], part.error);
}

/// A vector from the origin to approximately the nearest point of a polygon, of any length. It is a guess; the caller verifies
/// the result.
template <int Vertices>
Vec3 directionToPolygon(const std::array<Vec3, Vertices>& vertices) {
  const Vec3 normal = (vertices[1] - vertices[0]).cross(vertices[2] - vertices[1]);
  Vec3 nearest = normal.dot(vertices[0]) > 0.0 ? normal : Vec3(-normal);
  double smallest = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < Vertices; ++i) {
    const Vec3& from = vertices[i];
    const Vec3& to = vertices[(i + 1) % Vertices];
    if (normal.dot(from.cross(to)) > 0.0) continue;  // the origin is on the inner side of this edge
    const Vec3 edge = to - from;
    const double advance = -from.dot(edge);
    const double length2 = edge.squaredNorm();
    const Vec3 point = advance <= 0.0 ? from : advance >= length2 ? to : Vec3(from + advance / length2 * edge);
    const double distance2 = point.squaredNorm();
    if (distance2 < smallest) {
      smallest = distance2;
      nearest = point;
    }
  }
  return nearest;
}

/// Whether one fixed axis proves that the polygon does not contain the origin during a part of the step: every vertex moves in a
/// straight line, so the two ends are sufficient.
template <int Vertices>
bool isSeparated(const PolygonPart<Vertices>& part) {
  std::array<Vec3, Vertices> middle;
  for (std::size_t i = 0; i < Vertices; ++i) middle[i] = 0.5 * (part.from[i] + part.to[i]);
  Vec3 axis = directionToPolygon<Vertices>(middle);
  axis /= axis.cwiseAbs().maxCoeff();
  // Three products: the input error, and roundings that are smaller, since part.error is 4 roundings of the largest coordinate.
  const double error = 6.0 * part.error + kUnderflow;
  for (std::size_t i = 0; i < Vertices; ++i)
    if (!(axis.dot(part.from[i]) > error && axis.dot(part.to[i]) > error)) return false;
  return true;
}

/// Whether the polygon contains the origin at every time of a part of the step at which both lie in one plane: seen along a fixed
/// direction all turns (vertex i, vertex i + 1, origin) are strictly to the same side. Each is a quadratic in time, positive if
/// its Bernstein coefficients are.
template <int Vertices>
bool holdsOriginWhenCoplanar(const PolygonPart<Vertices>& part) {
  const auto& [from, to, inputError] = part;
  Vec3 direction = (from[1] + to[1] - from[0] - to[0]).cross(from[2] + to[2] - from[1] - to[1]);
  direction /= direction.cwiseAbs().maxCoeff();
  double size = inputError;
  for (std::size_t i = 0; i < Vertices; ++i) size = std::max({size, from[i].cwiseAbs().maxCoeff(), to[i].cwiseAbs().maxCoeff()});
  // Six products in a determinant, and twice as many for the one between both ends; a product of two coordinates has two input
  // errors and a square of one, and there are six roundings.
  const double error = 12.0 * (3.0 * inputError + 3.0 * kEpsilon * size) * size + kUnderflow;
  for (std::size_t i = 0; i < Vertices; ++i) {
    const std::size_t next = (i + 1) % Vertices;
    if (!(direction.dot(from[i].cross(from[next])) > error && direction.dot(to[i].cross(to[next])) > error &&
          direction.dot(from[i].cross(to[next]) + to[i].cross(from[next])) > error))
      return false;
  }
  return true;
}

/// Whether the cubic certainly changes its sign within `time`, widened to both sides by four times its width, and the polygon
/// contains the origin whenever that happens: then there is a contact in the widened interval.
template <int Vertices>
bool isCertainContact(const MovingPolygon<Vertices>& polygon, const TimeInterval& time) {
  const double margin = std::max(4.0 * (time.to - time.from), 4.0 * kEpsilon);
  const PolygonPart<Vertices> wide = partOf(polygon, {std::max(time.from - margin, 0.0), std::min(time.to + margin, 1.0)});
  const BernsteinCubic cubic = coplanarityCubic(wide);
  const double first = cubic.coefficients[0], last = cubic.coefficients[3];
  const bool changesSign = (first > cubic.error && last < -cubic.error) || (first < -cubic.error && last > cubic.error);
  return changesSign && holdsOriginWhenCoplanar(wide);
}

enum class Outcome { miss, hit, undecided };

struct Refined {
  Outcome outcome;
  double time;
};

/// Processes the parts of the step in the order of time. A part is shrunk to the interval in which the cubic can have roots; it
/// is dropped if there are none or an axis separates the features in it, and halved if it did not shrink much, until the features
/// hardly move in it.
template <int Vertices>
Refined refine(BernsteinCubic cubic, const MovingPolygon<Vertices>& polygon) {
  const double smallest = 0.0625 * kContactError * polygon.size;
  std::array<double, kMaxParts + 1> ends;  // of the parts still to come; each starts where the one before it ends
  int remaining = 0;
  ends[0] = 1.0;
  TimeInterval time{0.0, 1.0};
  PolygonPart<Vertices> part;
  for (int visited = 0; visited < kMaxParts; ++visited) {
    const double width = time.to - time.from;
    bool dropped = !clipToRoots(cubic, time);
    if (!dropped) {
      part = partOf(polygon, time);
      dropped = isSeparated(part);
    }
    if (dropped) {
      if (remaining == 0) return {Outcome::miss, 1.0};
      time = {ends[static_cast<std::size_t>(remaining)], ends[static_cast<std::size_t>(remaining - 1)]};
      --remaining;
      part = partOf(polygon, time);
    } else if ((time.to - time.from) * polygon.motion <= smallest) {
      if (!isCertainContact(polygon, time)) return {Outcome::undecided, time.from};
      clipToRoots(coplanarityCubic(part), time);
      return {Outcome::hit, time.from};
    } else if (time.to - time.from > 0.5 * width) {
      ends[static_cast<std::size_t>(remaining)] = time.to;
      ++remaining;
      time.to = 0.5 * (time.from + time.to);
      ends[static_cast<std::size_t>(remaining)] = time.to;
      part = partOf(polygon, time);
    }
    cubic = coplanarityCubic(part);
  }
  return {Outcome::undecided, time.from};
}

/// Whether no coordinate is larger than this. NaN is none.
bool areWithin(double most, const MovingPoint& a, const MovingPoint& b, const MovingPoint& c, const MovingPoint& d) {
  for (const MovingPoint* point : {&a, &b, &c, &d}) {
    if (!(point->start.array().abs() <= most).all() || !(point->end.array().abs() <= most).all()) return false;
  }
  return true;
}

/// The stages one after the other, the cheapest first. `boxesOverlap` and `exactly` are called with the points,
/// `polygonOf` gives their differences.
template <int Vertices, class BoxesOverlap, class PolygonOf, class Exactly>
TimeOfImpact decide(const MovingPoint& a, const MovingPoint& b, const MovingPoint& c, const MovingPoint& d, DecidedBy* decidedBy,
                    const BoxesOverlap& boxesOverlap, const PolygonOf& polygonOf, const Exactly& exactly) {
  DecidedBy ignored;
  DecidedBy& stage = decidedBy != nullptr ? *decidedBy : ignored;
  stage = DecidedBy::boxes;
  // What is not finite gets lost in comparisons, so that nothing is excluded with it.
  const bool multiplies = areWithin(kLargest, a, b, c, d);
  if (!multiplies && !areWithin(std::numeric_limits<double>::max(), a, b, c, d)) return {true, 0.0};
  if (!boxesOverlap(a, b, c, d)) return {false, 1.0};
  if (multiplies) {
    stage = DecidedBy::cubic;
    const BernsteinCubic cubic = coplanarityCubic(a, b, c, d);
    if (!mayVanish(cubic)) return {false, 1.0};
    stage = DecidedBy::refinement;
    const Refined refined = refine<Vertices>(cubic, polygonOf());
    if (refined.outcome != Outcome::undecided) return {refined.outcome == Outcome::hit, refined.time};
  }
  stage = DecidedBy::exact;
  return exactly(a, b, c, d);
}

}  // namespace

TimeOfImpact pointTriangleTimeOfImpact(const MovingPoint& point, const MovingPoint& a, const MovingPoint& b, const MovingPoint& c,
                                       DecidedBy* decidedBy) {
  const auto polygonOf = [&] { return differences<3>({&a, &b, &c}, {&point, &point, &point}); };
  return decide<3>(point, a, b, c, decidedBy, pointTriangleBoxesOverlap, polygonOf, exactPointTriangleTimeOfImpact);
}

TimeOfImpact edgeEdgeTimeOfImpact(const MovingPoint& a, const MovingPoint& b, const MovingPoint& c, const MovingPoint& d,
                                  DecidedBy* decidedBy) {
  const auto polygonOf = [&] { return differences<4>({&c, &d, &d, &c}, {&a, &a, &b, &b}); };
  return decide<4>(a, b, c, d, decidedBy, edgeEdgeBoxesOverlap, polygonOf, exactEdgeEdgeTimeOfImpact);
}

}  // namespace springtower
