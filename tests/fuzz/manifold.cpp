// Separating axes, contact manifolds and the tests of moving blocks against brute force, for two cuboids of any size and place.
#include "narrowphase/manifold.h"

#include "core/tuning.h"
#include "narrowphase/crossing.h"
#include "tests/fuzz/fuzz.h"

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <fmt/format.h>

namespace springtower {
namespace {

using Long3 = Eigen::Matrix<long double, 3, 1>;
using Axes = std::array<Vec3, 3>;

struct Box {
  Vec3 centre;
  Vec3 half;  // m, of its sides
  Eigen::Matrix3d turn;
};

struct Pair {
  Box upper;
  Box lower;
};

// Often flush, parallel or at right angles, as blocks of a tower are, and at all angles.
Eigen::Matrix3d turnOf(Bytes& bytes) {
  const int kind = bytes.below(4);
  Eigen::Quaterniond turn = Eigen::Quaterniond::Identity();
  if (kind == 1) turn = Eigen::AngleAxisd(bytes.between(-1.6, 1.6), Vec3::UnitZ());
  if (kind == 2)
    turn = Eigen::AngleAxisd(std::ldexp(bytes.between(-1.0, 1.0), -bytes.below(40)), Vec3::Unit(bytes.below(3)).eval());
  if (kind == 3) {
    turn.coeffs() = Eigen::Vector4d{bytes.between(-1, 1), bytes.between(-1, 1), bytes.between(-1, 1), 1.01};
    turn.normalize();
  }
  return turn.toRotationMatrix();
}

Vec3 vectorOf(Bytes& bytes, double least, double most) {
  Vec3 vector;
  for (int axis = 0; axis < 3; ++axis) vector[axis] = bytes.between(least, most);
  return vector;
}

// Sides from 1 to 100, the second block near the first, most often on it; all of it in units of a power of ten.
Pair pairOf(Bytes& bytes) {
  const double unit = std::pow(10.0, bytes.below(7) - 5);
  Pair pair;
  pair.lower = {Vec3::Zero(), unit * vectorOf(bytes, 0.5, bytes.below(2) == 0 ? 3.0 : 50.0), turnOf(bytes)};
  pair.upper = {Vec3::Zero(), unit * vectorOf(bytes, 0.5, bytes.below(2) == 0 ? 3.0 : 50.0), turnOf(bytes)};
  const Vec3 reach = pair.lower.half + pair.upper.half;
  Vec3 place = vectorOf(bytes, -1.2, 1.2).cwiseProduct(reach);
  // Resting on a face, to within some hundredths of a unit.
  if (bytes.below(2) == 0) place.z() = reach.z() + unit * bytes.between(-0.05, 0.05);
  pair.upper.centre = pair.lower.turn * place;
  pair.upper.turn = pair.lower.turn * pair.upper.turn;
  const Vec3 away = bytes.below(4) == 0 ? Vec3(unit * vectorOf(bytes, -1e3, 1e3)) : Vec3::Zero();
  pair.upper.centre += away;
  pair.lower.centre += away;
  return pair;
}

Vec3 cornerOf(const Box& box, std::size_t corner) {
  Vec3 local = box.half;
  for (std::size_t a = 0; a < 3; ++a)
    if ((corner >> a & 1U) == 0) local[static_cast<Eigen::Index>(a)] *= -1.0;
  return box.centre + box.turn * local;
}

ParticleArray cornersOf(const Pair& pair) {
  ParticleArray position;
  position.resize(2);
  for (std::size_t c = 0; c < kCorners; ++c) {
    position.set(0, c, cornerOf(pair.lower, c));
    position.set(1, c, cornerOf(pair.upper, c));
  }
  return position;
}

// What positions are off by, rounded, and what a figure of the pair may be off by.
double roundingOf(const Pair& pair) {
  return 1e-13 * (pair.lower.centre.norm() + pair.upper.centre.norm() + pair.lower.half.norm() + pair.upper.half.norm());
}

// The largest gap along the fifteen axes, in long double from the corners as they are.
long double gapOf(const ParticleArray& position, const Pair& pair) {
  long double best = -1e300L;
  const auto gapAlongAxis = [&](const Long3& axis) {
    const long double length = axis.norm();
    if (length < 1e-9L) return;
    std::array<long double, 2> least{1e300L, 1e300L};
    std::array<long double, 2> most{-1e300L, -1e300L};
    for (std::size_t block = 0; block < 2; ++block) {
      for (std::size_t c = 0; c < kCorners; ++c) {
        const long double along = axis.dot(position.at(block, c).cast<long double>()) / length;
        least[block] = std::min(least[block], along);
        most[block] = std::max(most[block], along);
      }
    }
    best = std::max({best, least[0] - most[1], least[1] - most[0]});
  };
  for (int i = 0; i < 3; ++i) {
    const Long3 a = pair.lower.turn.col(i).cast<long double>();
    gapAlongAxis(a);
    gapAlongAxis(pair.upper.turn.col(i).cast<long double>());
    for (int j = 0; j < 3; ++j) gapAlongAxis(a.cross(pair.upper.turn.col(j).cast<long double>()));
  }
  return best;
}

// A point's place in a box, in halves of its sides.
Vec3 placeIn(const Box& box, const Vec3& point) {
  return (box.turn.transpose() * (point - box.centre)).cwiseQuotient(box.half);
}

// The point of a box that is nearest to another one.
Vec3 nearestIn(const Box& box, const Vec3& point) {
  const Vec3 local = box.turn.transpose() * (point - box.centre);
  return box.centre + box.turn * local.cwiseMax(-box.half).cwiseMin(box.half);
}

void testSeparation(const ParticleArray& position, const Pair& pair, long double gap) {
  const Separation found = findSeparation(cornersOf(position, 1), cornersOf(position, 0));
  const double rounding = roundingOf(pair);
  const double size = pair.lower.half.norm() + pair.upper.half.norm();
  const std::string figures = fmt::format("got {}, true {}, size {}", found.best(), static_cast<double>(gap), size);
  if (found.best() > rounding) requireThat(gap > 0.0L, "blocks that are said to be apart are: " + figures);
  // Edges that are all but parallel are left out, which may hide so much.
  if (gap > 4.0 * tuning::kMinEdgeCross * size + rounding)
    requireThat(found.best() > 0.0, "blocks that are apart are said to be: " + figures);
  // Axes come from corners, which are rounded in proportion to their distance from the origin. The normal of edges that are all
  // but parallel is off by that over their sine; and of all directions, in which corners may be farther apart than along the
  // fifteen axes, it is one.
  const double least = std::min(pair.lower.half.minCoeff(), pair.upper.half.minCoeff());
  const double axes = 1e-15 + 1e-3 * rounding / least;
  const double turned = axes / tuning::kMinEdgeCross * size;
  requireThat(found.best() <= static_cast<double>(gap) + rounding + turned, "no gap is larger than the largest: " + figures);
  for (const double normal : {found.normalFaceA.norm(), found.normalFaceB.norm()})
    requireThat(std::abs(normal - 1.0) < 1e-9, "normals are of length 1");
  // Distances of points, by projecting from one block to the other and back.
  for (std::size_t c = 0; c < kCorners; ++c) {
    Vec3 a = cornerOf(pair.upper, c);
    for (int i = 0; i < 3; ++i) {
      const Vec3 b = nearestIn(pair.lower, a);
      a = nearestIn(pair.upper, b);
      requireThat((a - b).norm() >= found.best() - rounding, "no two points are nearer than the gap: " + figures);
    }
  }
}

double crossOf(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return a.x() * b.y() - a.y() * b.x();
}

// How far a point lies outside a polygon (any orientation), m; 0 inside.
double outside(const std::vector<Eigen::Vector2d>& polygon, const Eigen::Vector2d& point) {
  double nearest = 1e300;
  bool left = false;
  bool right = false;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Eigen::Vector2d& from = polygon[i];
    const Eigen::Vector2d side = polygon[(i + 1) % polygon.size()] - from;
    const double turn = crossOf(side, point - from);
    left = left || turn > 0.0;
    right = right || turn < 0.0;
    const double square = side.squaredNorm();
    const double share = square > 0.0 ? std::clamp((point - from).dot(side) / square, 0.0, 1.0) : 0.0;
    nearest = std::min(nearest, (point - from - share * side).norm());
  }
  return left && right ? nearest : polygon.size() < 3 ? nearest : 0.0;
}

// All points of the incident face that lie over the reference face, by a grid, are within the manifold's polygon.
void testCoverage(const Manifold& manifold, const Pair& pair, const ParticleArray& position, double mergeRadius) {
  constexpr int kGrid = 15;
  const FaceFrame face = faceFrame(cornersOf(position, 1), manifold.incidentFace);
  const Eigen::Vector2d lengths(face.sideU.norm(), face.sideV.norm());
  const int axis = manifold.referenceFace / 2;
  std::vector<Eigen::Vector2d> polygon;
  const ContactView view(manifold);
  for (std::size_t i = 0; i < static_cast<std::size_t>(manifold.count); ++i)
    polygon.push_back(lengths.cwiseProduct(Eigen::Vector2d(view.u(i), view.v(i))));
  for (int i = 0; i <= kGrid; ++i) {
    for (int j = 0; j <= kGrid; ++j) {
      const Eigen::Vector2d share(static_cast<double>(i) / kGrid - 0.5, static_cast<double>(j) / kGrid - 0.5);
      Vec3 place = placeIn(pair.lower, face.centre + share.x() * face.sideU + share.y() * face.sideV);
      place[axis] = 0.0;
      if (place.cwiseAbs().maxCoeff() > 1.0 - 1e-9) continue;
      requireThat(!polygon.empty(), "faces that overlap have points");
      const double off = outside(polygon, lengths.cwiseProduct(share));
      requireThat(off <= 3.0 * mergeRadius, fmt::format("the points span the overlap: {} m are left out, {} points, radius {}",
                                                        off, polygon.size(), mergeRadius));
    }
  }
}

void testManifold(const ParticleArray& position, const Pair& pair, double mergeRadius, double reach) {
  const CornerView upper = cornersOf(position, 1);
  const CornerView lower = cornersOf(position, 0);
  const Separation separation = findSeparation(upper, lower);
  const int incident = incidentFaceOf(upper, separation.normalFaceB);
  const double rounding = roundingOf(pair) + 1e-9 * mergeRadius;
  const FaceFrame reference = faceFrame(lower, separation.faceOfB);
  if (std::abs(faceFrame(upper, incident).normal.dot(reference.normal)) < 0.05) return;  // edge on: no overlap to speak of
  Manifold manifold;
  manifold.upper = 1;
  manifold.lower = 0;
  buildFaceManifold(upper, lower, incident, separation.faceOfB, {mergeRadius, reach}, manifold);
  requireThat(manifold.count >= 0 && manifold.count <= static_cast<int>(kManifoldPoints), "at most eight points");
  const ContactView view(manifold);
  for (std::size_t i = 0; i < static_cast<std::size_t>(manifold.count); ++i) {
    requireThat(std::abs(view.u(i)) <= 0.5 + 1e-9 && std::abs(view.v(i)) <= 0.5 + 1e-9, "points lie on the incident face");
    const Vec3 point = pointOnIncidentFace(view, upper, i);
    requireThat((point - reference.centre).dot(reference.normal) <= reach + rounding, "points lie within reach");
    Vec3 place = placeIn(pair.lower, point);
    place[separation.faceOfB / 2] = 0.0;
    requireThat(((place.cwiseAbs() - Vec3::Ones()).cwiseProduct(pair.lower.half)).maxCoeff() <= rounding,
                "points lie over the reference face");
    for (std::size_t j = 0; j < i; ++j)
      requireThat((pointOnIncidentFace(view, upper, j) - point).norm() >= mergeRadius - rounding, "points are apart");
  }
  Manifold whole = manifold;
  buildFaceManifold(upper, lower, incident, separation.faceOfB, {mergeRadius, 1e9}, whole);
  testCoverage(whole, pair, position, mergeRadius);
}

// A block that moves in a straight line from outside into another must meet it.
void testMove(Pair pair, const Vec3& away) {
  const double rounding = roundingOf(pair) + 1e-13 * away.norm();
  const ParticleArray end = cornersOf(pair);
  if (gapOf(end, pair) > -rounding) return;
  pair.upper.centre += away;
  const ParticleArray start = cornersOf(pair);
  if (gapOf(start, pair) < rounding) return;
  Counters counters;
  requireThat(featuresMeet({cornersOf(start, 1), cornersOf(end, 1)}, {cornersOf(start, 0), cornersOf(end, 0)}, counters),
              "a block that goes into another meets it");
}

void test(Bytes bytes) {
  const Pair pair = pairOf(bytes);
  const ParticleArray position = cornersOf(pair);
  const long double gap = gapOf(position, pair);
  testSeparation(position, pair, gap);
  const double least = 2.0 * std::min(pair.lower.half.minCoeff(), pair.upper.half.minCoeff());
  testManifold(position, pair, 1e-2 * least, bytes.between(-0.1, 1.0) * least);
  testMove(pair, (pair.lower.half.norm() + pair.upper.half.norm()) * vectorOf(bytes, -2.0, 2.0));
}

}  // namespace
}  // namespace springtower

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  springtower::test(springtower::Bytes(data, size));
  return 0;
}
