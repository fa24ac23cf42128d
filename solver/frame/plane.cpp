#include "solver/frame/plane.h"

namespace springtower {
namespace {

// Makes two corners mirror images of each other.
void mirror(ParticleArray& values, std::size_t block, std::size_t corner, std::size_t image) {
  const Vec3 one = values.at(block, corner);
  const Vec3 other = values.at(block, image);
  const Vec3 mean = 0.5 * (one + other);
  const double apart = 0.5 * (one.y() - other.y());
  values.set(block, corner, {mean.x(), apart, mean.z()});
  values.set(block, image, {mean.x(), -apart, mean.z()});
}

}  // namespace

void keepInPlane(Simulation& simulation) {
  for (std::size_t b = 0; b < simulation.model.blockCount(); ++b) {
    if (simulation.asleep[b] != 0) continue;
    Eigen::Index along = 0;
    simulation.scene.blocks[b].orientation.toRotationMatrix().row(1).cwiseAbs().maxCoeff(&along);
    const std::size_t bit = std::size_t{1} << static_cast<unsigned>(along);
    for (std::size_t corner = 0; corner < kCorners; ++corner) {
      if ((corner & bit) != 0) continue;
      mirror(simulation.state.position, b, corner, corner | bit);
      mirror(simulation.state.velocity, b, corner, corner | bit);
    }
  }
}

}  // namespace springtower
