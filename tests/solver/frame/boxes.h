#pragma once

#include "core/state.h"

#include <cmath>
#include <cstddef>
#include <vector>

namespace springtower {

/// A cuboid from which states of tests are built.
struct TestBox {
  Vec3 centre = Vec3::Zero();
  Vec3 dimensions = Vec3::Ones();
  Eigen::Quaterniond orientation = Eigen::Quaterniond::Identity();
};

/// The corners of undeformed cuboids.
inline ParticleArray cornersOf(const std::vector<TestBox>& boxes) {
  ParticleArray position;
  position.resize(boxes.size());
  for (std::size_t b = 0; b < boxes.size(); ++b) {
    for (std::size_t c = 0; c < kCorners; ++c) {
      const Vec3 side(cornerSide(c, 0), cornerSide(c, 1), cornerSide(c, 2));
      position.set(b, c, boxes[b].centre + boxes[b].orientation * (0.5 * side.cwiseProduct(boxes[b].dimensions)));
    }
  }
  return position;
}

/// The same boxes, rotated together about the origin and moved.
inline std::vector<TestBox> moved(std::vector<TestBox> boxes, const Eigen::Quaterniond& turn, const Vec3& move) {
  for (TestBox& box : boxes) {
    box.centre = turn * box.centre + move;
    box.orientation = turn * box.orientation;
  }
  return boxes;
}

/// Dimensions and rest lengths of undeformed cuboids of 1 kg.
inline BlockModel modelOf(const std::vector<TestBox>& boxes) {
  BlockModel model;
  for (const TestBox& box : boxes) {
    model.dimensions.push_back(box.dimensions);
    model.mass.push_back(1.0);
    for (std::size_t group = 1; group <= kSpringGroups; ++group) {
      Vec3 diagonal = Vec3::Zero();
      for (std::size_t a = 0; a < 3; ++a) {
        const auto axis = static_cast<Eigen::Index>(a);
        if (((group >> a) & 1U) != 0U) diagonal[axis] = box.dimensions[axis];
      }
      model.restLength[group - 1].push_back(diagonal.norm());
    }
  }
  return model;
}

inline Eigen::Quaterniond turned(double degrees, const Vec3& axis) {
  return Eigen::Quaterniond(Eigen::AngleAxisd(degrees * 3.14159265358979323846 / 180.0, axis.normalized()));
}

}  // namespace springtower
