#include "solver/block/shape_change.h"

namespace springtower {

double shapeChange(const ParticleArray& now, const ParticleArray& before, std::size_t block) {
  double squared = 0.0;
  for (std::size_t c = 0; c < kCorners; ++c) {
    for (std::size_t d = 0; d < c; ++d) {
      const double change = (now.at(block, c) - now.at(block, d)).norm() - (before.at(block, c) - before.at(block, d)).norm();
      squared += change * change;
    }
  }
  return squared / static_cast<double>(kCorners);
}

}  // namespace springtower
