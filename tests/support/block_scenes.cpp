#include "tests/support/block_scenes.h"

#include "solver/block/inertia.h"
#include "solver/block/springs.h"
#include "solver/explicit/stable_step.h"

#include <Eigen/Eigenvalues>
#include <cstdint>
#include <vector>

namespace springtower {

Simulation ringingBlock(Inertia inertia, Method method, double step_s, int steps, double omega) {
  Scene scene = oneBlockScene(false);
  scene.gravity.magnitude = 0.0;
  scene.settings.inertia = inertia;
  scene.settings.stiffnessDamping = 0.0;
  setSteps(scene.settings, method, step_s, steps);
  Simulation simulation(scene);
  setSprings(simulation.model, 0, 1.0, kBlockHeight_m, 0.0);
  const double radius = blockSpectralRadius(simulation.model, inertia, 0);
  setSprings(simulation.model, 0, omega * omega / radius, kBlockHeight_m, 0.0);
  return simulation;
}

Vector24 cornerVector(const ParticleArray& values, std::size_t block) {
  Vector24 result;
  for (std::size_t c = 0; c < kCorners; ++c) result.segment<3>(static_cast<Eigen::Index>(3 * c)) = values.at(block, c);
  return result;
}

void addCornerVector(const Vector24& change, ParticleArray& values, std::size_t block) {
  for (std::size_t c = 0; c < kCorners; ++c) values.add(block, c, change.segment<3>(static_cast<Eigen::Index>(3 * c)));
}

Matrix24 massMatrix(Inertia inertia, double mass) {
  const double own = mass / inverseMass(inertia).own;
  Matrix24 result = own * Matrix24::Identity();
  for (Eigen::Index c = 0; c < 8; ++c) {
    for (Eigen::Index d = 0; d < 8; ++d) {
      for (Eigen::Index a = 0; a < 3; ++a) result(3 * c + a, 3 * d + a) += (mass / 8.0 - own) / 8.0;
    }
  }
  return result;
}

Vector24 stiffestMode(const Simulation& simulation, std::size_t block) {
  const double change_m = 1e-6;  // errors go as its square over a block's side squared: 1e-9
  Matrix24 stiffness;
  const std::vector<AffineField> noContacts(simulation.model.blockCount());
  const std::vector<std::int32_t> only = {static_cast<std::int32_t>(block)};
  const auto forceAt = [&](Eigen::Index i, double by) {
    MotionState state = simulation.state;
    addCornerVector(by * Vector24::Unit(i), state.position, block);
    ParticleArray force;
    force.resize(simulation.model.blockCount());
    springForces(simulation.model, state, only, noContacts, force);
    return cornerVector(force, block);
  };
  for (Eigen::Index i = 0; i < 24; ++i) stiffness.col(i) = -(forceAt(i, change_m) - forceAt(i, -change_m)) / (2.0 * change_m);
  const Matrix24 symmetric = 0.5 * (stiffness + stiffness.transpose());
  const Matrix24 mass = massMatrix(simulation.scene.settings.inertia, simulation.model.mass[block]);
  const Eigen::GeneralizedSelfAdjointEigenSolver<Matrix24> solver(symmetric, mass);
  const Vector24 mode = solver.eigenvectors().col(23);
  return mode / mode.cwiseAbs().maxCoeff();
}

BreathingModes breathingModes(const BlockModel& model, Inertia inertia, std::size_t block) {
  const Vec3& side = model.dimensions[block];
  Eigen::Matrix3d elastic = Eigen::Matrix3d::Zero();
  for (std::size_t group = 1; group <= kSpringGroups; ++group) {
    Vec3 squared = Vec3::Zero();
    for (std::size_t a = 0; a < 3; ++a) {
      const auto axis = static_cast<Eigen::Index>(a);
      if (((group >> a) & 1U) != 0U) squared[axis] = side[axis] * side[axis];
    }
    elastic += 4.0 * model.springStiffness[group - 1][block] * squared * squared.transpose() / squared.sum();
  }
  const double part = inertia == Inertia::cuboid ? 1.0 / 12.0 : 1.0 / 4.0;
  const Eigen::Matrix3d moments = (part * model.mass[block] * side.cwiseAbs2()).asDiagonal();
  const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::Matrix3d> solver(elastic, moments);
  return {solver.eigenvalues(), solver.eigenvectors()};
}

UserForce constantForce(int block, int corner, const Vec3& force_n, double start_s, double end_s) {
  UserForce force;
  force.block = block;
  force.corner = corner;
  force.force = force_n;
  force.start_s = start_s;
  force.end_s = end_s;
  return force;
}

Momentum momentum(const Simulation& simulation) {
  Momentum sum;
  for (std::size_t b = 0; b < simulation.model.blockCount(); ++b) {
    const Vector24 p =
        massMatrix(simulation.scene.settings.inertia, simulation.model.mass[b]) * cornerVector(simulation.state.velocity, b);
    for (std::size_t c = 0; c < kCorners; ++c) {
      const Vec3 part = p.segment<3>(static_cast<Eigen::Index>(3 * c));
      sum.linear += part;
      sum.angular += simulation.state.position.at(b, c).cross(part);
    }
  }
  return sum;
}

}  // namespace springtower
