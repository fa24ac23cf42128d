#include "solver/explicit/stable_step.h"

#include "core/elementary.h"
#include "core/hash.h"
#include "solver/block/inertia.h"
#include "solver/block/springs.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace springtower {

namespace {

// A point's weights on a block's affine part, in its mass metric: the centre has mass m, each side m/12 for a cuboid and m/4 for
// eight lumps (8 corners of m/own, half a side away).
Eigen::Vector4d affineWeights(const std::array<double, 3>& place, Inertia inertia, double mass) {
  const double side = std::sqrt(0.5 * inverseMass(inertia).own);
  return Eigen::Vector4d(1.0, side * place[0], side * place[1], side * place[2]) / std::sqrt(mass);
}

std::array<double, 3> edgeEnd(int edge) {
  const int along = edge / 4;
  std::array<double, 3> place{0.5, 0.5, 0.5};
  place[along == 0 ? 1 : 0] = (edge & 1) != 0 ? 0.5 : -0.5;
  place[along == 2 ? 1 : 2] = (edge & 2) != 0 ? 0.5 : -0.5;
  return place;
}

// The stiffness of each block's contacts on its affine part, over its mass (1/s2). It uses the memory in which implicit steps
// keep extrapolated positions (scratch.pastPosition): columns 0 and 1 of the matrix in the x of the corners, 2 and 3 in their y.
Eigen::Map<Eigen::Vector4d> metricColumn(Engine& engine, std::size_t block, std::size_t column) {
  return Eigen::Map<Eigen::Vector4d>(engine.scratch.pastPosition.values(column / 2, block) + 4 * (column % 2));
}

Eigen::Matrix4d metricOf(Engine& engine, std::size_t block) {
  Eigen::Matrix4d metric;
  for (std::size_t j = 0; j < 4; ++j) metric.col(static_cast<Eigen::Index>(j)) = metricColumn(engine, block, j);
  return metric;
}

void addManifold(Simulation& simulation, const ContactView& m) {
  Engine& engine = *simulation.engine;
  const Settings& settings = simulation.scene.settings;
  const auto upper = static_cast<std::size_t>(m.upper);
  const auto lower = static_cast<std::size_t>(std::max(m.lower, 0));
  const bool moveUpper = simulation.asleep[upper] == 0;
  const bool moveLower = m.lower >= 0 && simulation.asleep[lower] == 0;
  const double share = moveUpper && moveLower ? 1.0 : 0.5;  // the factor of two does not apply against what cannot move
  const double stiffness = pairStiffness(simulation.stiffness, m.upper, m.lower) *
                           std::max(1.0 + settings.maxwellRatio, settings.tangentialRatio) * share;
  const auto add = [&](std::size_t block, const std::array<double, 3>& place, double k) {
    const Eigen::Vector4d w = affineWeights(place, settings.inertia, simulation.model.mass[block]);
    for (std::size_t j = 0; j < 4; ++j) metricColumn(engine, block, j) += k * w * w[static_cast<Eigen::Index>(j)];
  };
  for (std::size_t p = 0; p < static_cast<std::size_t>(m.count); ++p) {
    const double k = stiffness * m.penalty(p).stiffening[laneOf(p)];
    if (m.phase == PairPhase::edge) {
      if (moveUpper) add(upper, edgeEnd(m.incidentFace), k);
      if (moveLower) add(lower, edgeEnd(m.referenceFace), k);
      continue;
    }
    const FaceAxes& face = kFaceAxes[static_cast<std::size_t>(m.incidentFace)];
    std::array<double, 3> place{};
    place[face.across] = face.side;
    place[face.u] = m.u(p);
    place[face.v] = m.v(p);
    if (moveUpper) add(upper, place, k);
    if (!moveLower) continue;
    const BlockFrame& above = engine.memo.frames[upper];
    const BlockFrame& below = engine.memo.frames[lower];
    std::array<double, 3> arm{};
    for (std::size_t a = 0; a < 3; ++a) {
      arm[a] = above.place.centre[a] - below.place.centre[a];
      for (std::size_t i = 0; i < 3; ++i) arm[a] += place[i] * above.place.side[i][a];
    }
    std::array<double, 3> foot{};
    for (std::size_t i = 0; i < 3; ++i)
      foot[i] = below.dual[i][0] * arm[0] + below.dual[i][1] * arm[1] + below.dual[i][2] * arm[2];
    add(lower, foot, k);
  }
}

}  // namespace

SpectralBound spectralBound(Simulation& simulation, std::span<const std::int32_t> blocks, std::span<const std::int32_t> pairs) {
  Engine& engine = *simulation.engine;
  computeFrames(simulation.state.position, blocks, engine.memo.frames);
  for (const std::int32_t block : blocks) {
    for (std::size_t j = 0; j < 4; ++j) metricColumn(engine, static_cast<std::size_t>(block), j).setZero();
  }
  for (const std::int32_t at : pairs) {
    const ContactView manifold = contactOf(engine, static_cast<std::size_t>(at));
    if (manifold.phase != PairPhase::separated) addManifold(simulation, manifold);
  }
  double springs = 0.0;
  double contacts = 0.0;
  std::int32_t ofSprings = blocks.front();
  std::int32_t ofContacts = blocks.front();
  for (const std::int32_t block : blocks) {
    const auto b = static_cast<std::size_t>(block);
    if (engine.springRadius[b] > springs) ofSprings = block;
    springs = std::max(springs, engine.springRadius[b]);
    // The trace is an upper bound as well, and often shows that a block is not the largest.
    const Eigen::Matrix4d metric = metricOf(engine, b);
    if (metric.trace() <= contacts) continue;
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix4d> solver(metric, Eigen::EigenvaluesOnly);
    if (solver.eigenvalues()[3] > contacts) ofContacts = block;
    contacts = std::max(contacts, solver.eigenvalues()[3]);
  }
  return {springs + 2.0 * contacts, 2.0 * contacts > springs ? ofContacts : ofSprings};
}

double blockSpectralRadius(const BlockModel& model, Inertia inertia, std::size_t block) {
  using Matrix24 = Eigen::Matrix<double, 24, 24>;
  const InverseMass inverse = inverseMass(inertia);
  // M^-1/2: one factor for the mean of a component, another for the deviation from it.
  const double mass = model.mass[block];
  const double mean = std::sqrt((inverse.own - 8.0 * inverse.shared) / mass);
  const double own = std::sqrt(inverse.own / mass);
  Matrix24 root = Matrix24::Zero();
  for (Eigen::Index c = 0; c < 8; ++c) {
    for (Eigen::Index d = 0; d < 8; ++d) {
      for (Eigen::Index a = 0; a < 3; ++a) root(3 * c + a, 3 * d + a) = (mean - own) / 8.0 + (c == d ? own : 0.0);
    }
  }
  const Matrix24 symmetric = root * springStiffnessMatrix(model, block) * root;
  return Eigen::SelfAdjointEigenSolver<Matrix24>(symmetric, Eigen::EigenvaluesOnly).eigenvalues()[23];
}

std::uint64_t contactSignature(const Engine& engine, std::span<const std::int32_t> pairs) {
  Hash hash;
  for (const std::int32_t at : pairs) {
    const ContactView m = contactOf(engine, static_cast<std::size_t>(at));
    if (m.phase == PairPhase::separated) continue;
    hash.word(static_cast<std::uint64_t>(at));
    hash.word(static_cast<std::uint64_t>(m.count) + 16U * static_cast<std::uint64_t>(m.incidentFace) +
              256U * static_cast<std::uint64_t>(m.referenceFace));
    for (std::size_t p = 0; p < static_cast<std::size_t>(m.count); ++p)
      hash.word(static_cast<std::uint64_t>(16.0 * elementary::log2(m.penalty(p).stiffening[laneOf(p)])));
  }
  return hash.value();
}

}  // namespace springtower
