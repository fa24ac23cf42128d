#pragma once

#include "core/scene/scene.h"
#include "solver/statics/contacts.h"

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

namespace springtower {

using Vec6 = Eigen::Matrix<double, 6, 1>;

/// A point at which one block may push another, or the floor a block.
struct ForcePoint {
  std::int32_t upper = -1;
  std::int32_t lower = -1;  ///< -1: the floor, or a fixed block
  Vec3 place = Vec3::Zero();
  Eigen::Matrix3d frame = Eigen::Matrix3d::Identity();  ///< columns: the normal (from lower to upper) and two tangents
  double gap_m = 0.0;
  double friction = 0.0;   ///< static coefficient there
  std::size_t facing = 0;  ///< index of the facing it belongs to
};

/// Rigid blocks, their potential contact points, and their weights: the data of an equilibrium problem. Forces are in mean block
/// weights and lengths in mean block heights, so that scenes of any size and density give the same numbers.
///
/// Equilibrium is A f + w = 0: f has three components for each point in its frame (normal, two tangents: the force on the upper
/// block), A maps it to force and torque about its centre of every block, and w are the loads; all with six rows for each block.
struct StaticsModel {
  std::vector<Vec3> centre;    ///< m
  std::vector<double> weight;  ///< in mean block weights; 0 for fixed blocks, on which no forces are counted
  std::vector<ForcePoint> points;
  double friction = 0.0;      ///< the largest static coefficient of all points; the scene's where there are none
  double forceUnit_n = 1.0;   ///< mean block weight
  double lengthUnit_m = 1.0;  ///< mean least side of the blocks

  [[nodiscard]] std::size_t blockCount() const { return centre.size(); }

  /// Force and torque (about its centre) on a block by a unit force along each axis of the point's frame: 6 x 3; for the point's
  /// lower block the reaction.
  [[nodiscard]] Eigen::Matrix<double, 6, 3> wrench(const ForcePoint& point, bool onUpper) const;

  /// Loads of all blocks, [6 blocks], under a gravity of this direction and relative magnitude (1: that of the scene).
  [[nodiscard]] Eigen::VectorXd gravityLoad(const Vec3& gravity) const;
};

/// The model of a scene with the points of `facings`. Throws InputError when the scene has no gravity or no blocks.
StaticsModel staticsModel(const Scene& scene, std::span<const FacePair> facings);

}  // namespace springtower
