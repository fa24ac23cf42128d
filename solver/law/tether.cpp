#include "solver/law/tether.h"

#include "core/rotation_vector.h"
#include "solver/block/inertia.h"

namespace springtower {

namespace {

// Each of eight corners is half an edge from the centre: the edge's forces are halved at the corners, and halved again in the
// generalised force of the edge.
constexpr double kOnEdge = 0.25 * kCorners;

// A vector shortened to at most this length.
Vec3 within(const Vec3& vector, double length) {
  const double norm = vector.norm();
  return norm > length ? Vec3(vector * (length / norm)) : vector;
}

// Its derivative.
Eigen::Matrix3d withinSlope(const Vec3& vector, double length) {
  const double norm = vector.norm();
  if (!(norm > length)) return Eigen::Matrix3d::Identity();
  const Vec3 way = vector / norm;
  return length / norm * (Eigen::Matrix3d::Identity() - way * way.transpose());
}

// Force of the tether on the block's centre without its limits.
struct CentrePull {
  Vec3 missing;   // m, from the block to the copy
  Vec3 distance;  // m, the same, limited to the springs' largest extension
  Vec3 wanted;    // N
  Vec3 along;     // N, its part along the hand's line
  Vec3 across;    // N, the rest
};

CentrePull centrePull(const Tether& tether, const MotionState& state, double ahead_s) {
  const std::size_t b = index(tether.block);
  CentrePull pull;
  pull.missing = tether.place + ahead_s * tether.velocity - centre(state.position, b);
  pull.distance = within(pull.missing, tether.limit_n / tether.stiffness_n_m);
  pull.wanted = tether.stiffness_n_m * pull.distance + tether.damping_n_s_m * (tether.velocity - centre(state.velocity, b)) +
                tether.carried_n;
  pull.along = pull.wanted.dot(tether.line) * tether.line;
  pull.across = pull.wanted - pull.along;
  return pull;
}

// Rotating forces of the tether without their limit. The tether holds the two longer mean edges: warps are left to the block's
// own springs, and so is the shortest edge, which friction on the faces shears without rotating the block.
struct EdgePull {
  Eigen::Matrix3d edges;   // m
  Eigen::Matrix3d wanted;  // N, one column per edge: the force on a corner is half the sum of the columns, with its signs
  Vec3 torque;             // N m
};

Eigen::Index shortestEdge(const BlockModel& model, std::size_t block) {
  Eigen::Index shortest = 0;
  model.dimensions[block].minCoeff(&shortest);
  return shortest;
}

EdgePull edgePull(const Tether& tether, const BlockModel& model, const MotionState& state, double ahead_s) {
  const std::size_t b = index(tether.block);
  const Eigen::Matrix3d axes = (rotation(ahead_s * tether.spin) * tether.turn).toRotationMatrix();
  const Eigen::Matrix3d copy = axes * model.dimensions[b].asDiagonal();
  EdgePull pull;
  pull.edges = meanEdges(state.position, b);
  Eigen::Matrix3d turning;
  for (int a = 0; a < 3; ++a) turning.col(a) = tether.spin.cross(copy.col(a));
  const Vec3 stiffness(tether.cornerStiffness_n_m, tether.cornerStiffness_n_m, tether.tiltStiffness_n_m);
  const Vec3 damping(tether.cornerDamping_n_s_m, tether.cornerDamping_n_s_m, tether.tiltDamping_n_s_m);
  pull.wanted = stiffness.asDiagonal() * (copy - pull.edges) + damping.asDiagonal() * (turning - meanEdges(state.velocity, b));
  pull.wanted.col(shortestEdge(model, b)).setZero();
  pull.wanted += tether.carriedOnEdges_n;
  pull.torque = Vec3::Zero();
  for (int a = 0; a < 3; ++a) pull.torque += kOnEdge * pull.edges.col(a).cross(pull.wanted.col(a));
  return pull;
}

double shareOf(const Vec3& torque, double limit_n_m) {
  const double size = torque.norm();
  return size > limit_n_m ? limit_n_m / size : 1.0;
}

}  // namespace

Eigen::Matrix3d forcesOnEdges(const Vec3& torque_n_m, const Eigen::Matrix3d& edges) {
  const Eigen::Matrix3d resists = edges.squaredNorm() * Eigen::Matrix3d::Identity() - edges * edges.transpose();
  const Vec3 turn = resists.inverse() * torque_n_m / kOnEdge;
  Eigen::Matrix3d forces;
  for (int a = 0; a < 3; ++a) forces.col(a) = turn.cross(edges.col(a));
  return forces;
}

GripForce tetherForces(const Tether& tether, const BlockModel& model, const MotionState& state, double time_s,
                       std::array<Vec3, kCorners>& corner) {
  const double ahead_s = time_s - tether.time_s;
  const CentrePull pull = centrePull(tether, state, ahead_s);
  GripForce sum;
  sum.force = within(tether.line.isZero(0.0) ? pull.wanted : Vec3(pull.along + within(pull.across, tether.acrossLimit_n)),
                     tether.limit_n);
  sum.acrossLimited = !tether.line.isZero(0.0) && pull.across.norm() > tether.acrossLimit_n;
  sum.limited = pull.wanted.norm() > tether.limit_n || pull.distance.norm() < pull.missing.norm();

  const EdgePull turn = edgePull(tether, model, state, ahead_s);
  const double share = shareOf(turn.torque, tether.torqueLimit_n_m);
  sum.turnLimited = share < 1.0;
  sum.torque = share * turn.torque;
  for (std::size_t c = 0; c < kCorners; ++c) {
    const Vec3 sides = 0.5 * Vec3(cornerSide(c, 0), cornerSide(c, 1), cornerSide(c, 2));
    corner[c] = share * turn.wanted * sides + sum.force / static_cast<double>(kCorners);
  }
  return sum;
}

TetherMatrix tetherResistance(const Tether& tether, const BlockModel& model, const MotionState& state, double time_s,
                              double step_s) {
  const double ahead_s = time_s - tether.time_s;
  TetherMatrix result = TetherMatrix::Zero();
  const CentrePull pull = centrePull(tether, state, ahead_s);
  const Eigen::Matrix3d identity = Eigen::Matrix3d::Identity();
  const Eigen::Matrix3d wanted = tether.stiffness_n_m * withinSlope(pull.missing, tether.limit_n / tether.stiffness_n_m) +
                                 tether.damping_n_s_m / step_s * identity;
  if (tether.line.isZero(0.0)) {
    result.topLeftCorner<3, 3>() = withinSlope(pull.wanted, tether.limit_n) * wanted;
  } else {
    const Eigen::Matrix3d onLine = tether.line * tether.line.transpose();
    const Vec3 force = pull.along + within(pull.across, tether.acrossLimit_n);
    result.topLeftCorner<3, 3>() = withinSlope(force, tether.limit_n) *
                                   (onLine + withinSlope(pull.across, tether.acrossLimit_n) * (identity - onLine)) * wanted;
  }

  const EdgePull turn = edgePull(tether, model, state, ahead_s);
  const double level = kOnEdge * (tether.cornerStiffness_n_m + tether.cornerDamping_n_s_m / step_s);
  const double tilt = kOnEdge * (tether.tiltStiffness_n_m + tether.tiltDamping_n_s_m / step_s);
  const Vec3 resists(level, level, tilt);
  const double share = shareOf(turn.torque, tether.torqueLimit_n_m);
  const Eigen::Index free = shortestEdge(model, index(tether.block));
  for (Eigen::Index a = 0; a < 3; ++a) {
    if (a != free) result.diagonal().segment<3>(3 + 3 * a) = share * resists;
  }
  if (share < 1.0 && share > 0.0) {
    // The share decreases as the torque grows.
    const Vec3 way = turn.torque.normalized();
    const Eigen::Matrix3d force = kOnEdge * turn.wanted;
    for (int b = 0; b < 3; ++b) {
      const Vec3 spring = b == free ? Vec3(Vec3::Zero()) : Vec3(resists.cwiseProduct(way.cross(turn.edges.col(b))));
      const Vec3 growth = (force.col(b).cross(way) - spring) / turn.torque.norm();
      for (int a = 0; a < 3; ++a) result.block<3, 3>(3 + 3 * a, 3 + 3 * b) += share * force.col(a) * growth.transpose();
    }
  }
  return result;
}

}  // namespace springtower
