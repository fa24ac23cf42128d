#pragma once

#include "core/ids.h"
#include "core/tuning.h"
#include "core/vector.h"

#include <Eigen/Geometry>

namespace springtower {

/// Target of the hand in one frame.
struct Hand {
  BlockId block = kFloor;                                    ///< kFloor: no block is held
  Vec3 place = Vec3::Zero();                                 ///< m, target of the block's centre at the frame's end
  Eigen::Quaterniond turn = Eigen::Quaterniond::Identity();  ///< from the block's axes to the world's; unit
  double limit_n = tuning::kGripForce_n;  ///< N, largest force; the torque is limited to this times half the block's middle side,
                                          ///< as for two fingers on its sides
  Vec3 velocity = Vec3::Zero();           ///< m/s, of the place during the frame
  double rate_rad_s = tuning::kFollowFrequency_rad_s;  ///< natural frequency of the spring to its place
  Vec3 line = Vec3::Zero();  ///< unit if the hand draws along a line, otherwise zero. The block's supports then determine its
                             ///< height, and the hand supports its overhang, so that its other end does not lift blocks on it;
                             ///< both are limited by the block's weight
};

}  // namespace springtower
