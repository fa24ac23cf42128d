#include "solver/explicit/strain_limit.h"

#include "core/nearest_rotation.h"
#include "core/tuning.h"
#include "solver/block/affine.h"
#include "solver/block/shape_change.h"
#include "solver/world/over_island.h"

#include <Eigen/LU>
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
  const double kLookedAt = 0.25 * tuning::kMaxStrain;
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
  // What differs from the nearest rigid block has no moment about it, so that taking it back turns no block.
  const Corners rigid = nearestRotation(corners * rest.transpose()) * rest;
  const double strain = strainOf(corners - rigid, dimensions);
  if (!(strain > tuning::kMaxStrain)) return;
  const double diverged = tuning::kMaxDeformationPerStep * dimensions.minCoeff();
  if (!(shapeChange(state.position, step.engine.memo.previous, block) < diverged * diverged)) return;
  moveRigidly(state, block, corners, rigid + tuning::kMaxStrain / strain * (corners - rigid));
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

}  // namespace springtower
