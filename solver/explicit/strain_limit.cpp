#include "solver/explicit/strain_limit.h"

#include "core/tuning.h"
#include "solver/block/affine.h"
#include "solver/block/inertia.h"
#include "solver/block/shape_change.h"
#include "solver/world/over_island.h"

#include <Eigen/LU>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <cstddef>

namespace springtower {

namespace {

// Distances of a block's corners from its centre as columns, m.
using Corners = Eigen::Matrix<double, 3, kCorners>;

Corners cornersOf(const ParticleArray& position, std::size_t block, const Vec3& middle) {
  Corners corners;
  for (std::size_t c = 0; c < kCorners; ++c) corners.col(static_cast<Eigen::Index>(c)) = position.at(block, c) - middle;
  return corners;
}

Corners restCorners(const Vec3& dimensions) {
  Corners corners;
  for (std::size_t c = 0; c < kCorners; ++c) {
    const Vec3 sides(cornerSide(c, 0), cornerSide(c, 1), cornerSide(c, 2));
    corners.col(static_cast<Eigen::Index>(c)) = 0.5 * sides.cwiseProduct(dimensions);
  }
  return corners;
}

// The rotation that takes a rigid block's corners nearest to these, in the sum of squares (Kabsch 1976). What differs from it
// then has no moment about the rigid corners, so that a displacement along it changes no angular momentum.
Eigen::Matrix3d nearestRotation(const Corners& corners, const Corners& rest) {
  const Eigen::Matrix3d moments = corners * rest.transpose();
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(moments, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const double handed = (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0.0 ? -1.0 : 1.0;
  return svd.matrixU() * Vec3(1.0, 1.0, handed).asDiagonal() * svd.matrixV().transpose();
}

// The largest difference of an edge from that of the rigid block, over its length; `apart`: of the corners, m.
double strainOf(const Corners& apart, const Vec3& dimensions) {
  double most = 0.0;
  for (std::size_t c = 0; c < kCorners; ++c) {
    for (std::size_t a = 0; a < 3; ++a) {
      const std::size_t other = c | (std::size_t{1} << a);
      const Vec3 edge = apart.col(static_cast<Eigen::Index>(other)) - apart.col(static_cast<Eigen::Index>(c));
      most = std::max(most, edge.norm() / dimensions[static_cast<Eigen::Index>(a)]);
    }
  }
  return most;
}

// Whether the affine part of a shape has so much strain that an edge may be past the limit: stretch of its mean edges, cosines
// between them.
bool maySurpassLimit(const BlockFrame& frame, const Vec3& dimensions) {
  constexpr double kLookedAt = 0.25 * tuning::kMaxStrain;
  const auto& side = frame.place.side;
  const auto dot = [&](std::size_t a, std::size_t b) {
    return side[a][0] * side[b][0] + side[a][1] * side[b][1] + side[a][2] * side[b][2];
  };
  for (std::size_t a = 0; a < 3; ++a) {
    const std::size_t b = (a + 1) % 3;
    const double length = dimensions[static_cast<Eigen::Index>(a)];
    const double stretch = dot(a, a) / (length * length) - 1.0;  // twice it, where it is small
    const double cosine = dot(a, b) / (length * dimensions[static_cast<Eigen::Index>(b)]);
    if (!(std::abs(stretch) <= 2.0 * kLookedAt && std::abs(cosine) <= kLookedAt)) return true;
  }
  return false;
}

// Places a block's corners at `arms` from its centre; they move as a rigid block of the same momentum and angular momentum. In
// either inertia what the corners move by beside their mean has equal weight.
void moveRigidly(MotionState& state, std::size_t block, const Corners& before, const Corners& arms) {
  const Vec3 middle = centre(state.position, block);
  const Vec3 velocity = centre(state.velocity, block);
  const Corners motion = cornersOf(state.velocity, block, velocity);
  Vec3 momentum = Vec3::Zero();
  Eigen::Matrix3d moment = Eigen::Matrix3d::Zero();
  for (Eigen::Index c = 0; c < arms.cols(); ++c) {
    const Vec3 arm = arms.col(c);
    momentum += Vec3(before.col(c)).cross(Vec3(motion.col(c)));
    moment += arm.squaredNorm() * Eigen::Matrix3d::Identity() - arm * arm.transpose();
  }
  const Vec3 spin = moment.inverse() * momentum;
  for (std::size_t c = 0; c < kCorners; ++c) {
    const Vec3 arm = arms.col(static_cast<Eigen::Index>(c));
    state.position.set(block, c, middle + arm);
    state.velocity.set(block, c, velocity + spin.cross(arm));
  }
}

void limitBlock(const IslandStep& step, std::size_t block) {
  MotionState& state = step.simulation.state;
  const Vec3& dimensions = step.simulation.model.dimensions[block];
  const Corners corners = cornersOf(state.position, block, centre(state.position, block));
  const Corners rest = restCorners(dimensions);
  const Corners rigid = nearestRotation(corners, rest) * rest;
  const double strain = strainOf(corners - rigid, dimensions);
  if (!(strain > tuning::kMaxStrain)) return;
  const double diverged = tuning::kMaxDeformationPerStep * dimensions.minCoeff();
  if (!(shapeChange(state.position, step.engine.memo.previous, block) < diverged * diverged)) return;
  moveRigidly(state, block, corners, rigid + tuning::kMaxStrain / strain * (corners - rigid));
}

// Adds what a block needs that loads of these sizes (N, N m) act on, by its spin now, what they may add to it in the frame, and
// what they do to a corner.
void addBlock(const IslandStep& step, std::int32_t block, double force, double torque, MotionBound& bound) {
  const Simulation& simulation = step.simulation;
  const auto b = static_cast<std::size_t>(block);
  const Vec3& dimensions = simulation.model.dimensions[b];
  const double frame_s = simulation.scene.settings.frame_s;
  const double mass = simulation.model.mass[b];
  const double own = inverseMass(simulation.scene.settings.inertia).own;
  const double arm = 0.5 * dimensions.norm();
  const double side = dimensions.minCoeff();
  const Vec3 squares = dimensions.cwiseAbs2();
  const double moment = 2.0 * mass / own * (squares.sum() - squares.maxCoeff());  // the least principal one
  // A constant force gives no more spin than its work on a corner that it takes from one side of the block to the other.
  const double added =
      std::min(force * arm / moment * frame_s, std::sqrt(4.0 * force * arm / moment)) + torque / moment * frame_s;
  const double spin = rigidMotion(simulation.state, b).spin.norm();
  // A step along the tangents stretches the longest edge by half the square of the turn; compared with the least one.
  const double turn = tuning::kMaxExplicitTurn * std::sqrt(side / dimensions.maxCoeff());
  const double acceleration = own * (force + torque / side) / mass;
  const double pushed = std::sqrt(acceleration / (2.0 * tuning::kMaxExplicitPush * side));
  const double steps = frame_s * std::max((spin + added) / turn, pushed);
  bound.spin = std::max(bound.spin, spin);
  if (!(steps > bound.steps)) return;
  bound.steps = steps;
  bound.block = block;
}

}  // namespace

void limitStrain(const IslandStep& step) {
  overBlocks(step, [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) {
      const auto block = static_cast<std::size_t>(step.blocks[i]);
      // The frames are those of the last evaluation of forces: of the step before, or of its last stage.
      if (maySurpassLimit(step.engine.memo.frames[block], step.simulation.model.dimensions[block])) limitBlock(step, block);
    }
  });
}

MotionBound motionBound(const IslandStep& step) {
  const Simulation& simulation = step.simulation;
  const double begin_s = simulation.time_s;
  const double end_s = begin_s + simulation.scene.settings.frame_s;
  MotionBound bound;
  for (const std::int32_t block : step.blocks) {
    double force = 0.0;
    double torque = 0.0;
    for (const UserForce& user : simulation.scene.forces) {
      if (user.block != block || !user.actsWithin(begin_s, end_s)) continue;
      const Load load = user.at(std::max(begin_s, user.start_s));
      const Load later = user.at(std::min(end_s, user.end_s));
      if (user.corner >= 0 || user.point) force += std::max(load.force.norm(), later.force.norm());
      torque += std::max(load.torque.norm(), later.torque.norm());
    }
    addBlock(step, block, force, torque, bound);
  }
  bound.steps = std::ceil(bound.steps);
  return bound;
}

}  // namespace springtower
