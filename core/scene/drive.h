#pragma once

#include "core/limits.h"
#include "core/vector.h"

#include <Eigen/Geometry>
#include <span>

namespace springtower {

/// A prescribed motion of a fixed block over a time: a velocity, a spin about its centre, and an oscillation. A block with
/// several moves by all of them: displacements add up, rotations follow one another in the order of the drives. Before its start
/// a drive does nothing; from its end on the block stays where it has come to.
struct Drive {
  int block = 0;                   ///< counted from 0
  Vec3 velocity = Vec3::Zero();    ///< m/s
  Vec3 spin = Vec3::Zero();        ///< rad/s, world axes
  Vec3 amplitude = Vec3::Zero();   ///< m; displaces by amplitude (1 - cos(2 pi f t)): from rest, to twice this and back
  double frequency_hz = 0.0;       ///< Hz
  double start_s = 0.0;            ///< s
  double end_s = kTimeRange.most;  ///< s

  /// Whether it moves its block in some part of the time from `begin_s` to `end`, s.
  [[nodiscard]] bool actsWithin(double begin_s, double end) const { return start_s < end && end_s > begin_s; }
  /// Upper bound of the speed of a block's corners that it gives, m/s; `radius_m`: of the farthest corner from the centre.
  [[nodiscard]] double mostSpeed_m_s(double radius_m) const;
};

/// Where drives have brought a block.
struct DrivenPose {
  Vec3 centre = Vec3::Zero();                                ///< m
  Eigen::Quaterniond turn = Eigen::Quaterniond::Identity();  ///< from the orientation at the start
  Vec3 velocity = Vec3::Zero();                              ///< m/s, of the centre
  Vec3 spin = Vec3::Zero();                                  ///< rad/s
  double travel_m = 0.0;                                     ///< upper bound of the path of its corners so far
};

/// The pose of a block at a time (s), a function of the time alone; `centre` and `radius_m` are those of the block as placed.
/// Drives of other blocks are passed over.
DrivenPose drivenPose(std::span<const Drive> drives, int block, const Vec3& centre, double radius_m, double time_s);

}  // namespace springtower
