#include "solver/stability.h"

#include "solver/block_frames.h"
#include "solver/inertia.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace springtower {

namespace {

// K times the mode: the springs' part, along each spring's direction now (what changes of direction add is small against the stiffness).
void springPart(const BlockModel& model, const CornerArray& position, const CornerArray& mode, std::size_t b, CornerArray& force) {
  std::array<std::array<double, kCorners>, 3> sum{};
  for (std::size_t group = 1; group <= kSpringGroups; ++group) {
    const double stiffness = model.springStiffness[group - 1][b];
    for (std::size_t c = 0; c < kCorners; ++c) {
      const std::size_t partner = c ^ group;
      if (partner < c) continue;
      const Vec3 along = (position.at(b, partner) - position.at(b, c)).normalized();
      const Vec3 f = stiffness * along.dot(mode.at(b, partner) - mode.at(b, c)) * along;
      for (std::size_t a = 0; a < 3; ++a) {
        sum[a][partner] += f[static_cast<Eigen::Index>(a)];
        sum[a][c] -= f[static_cast<Eigen::Index>(a)];
      }
    }
  }
  for (std::size_t a = 0; a < 3; ++a) std::copy(sum[a].begin(), sum[a].end(), force.values(a, b));
}

// Block coordinates of a manifold's point on its upper and its lower block, and its normal.
struct PointPlace {
  std::array<double, 3> upper;
  std::array<double, 3> lower{};
  Vec3 normal = Vec3::UnitZ();
};

Vec3 vectorOf(const std::array<double, 3>& values) { return {values[0], values[1], values[2]}; }

std::array<double, 3> edgeMiddle(int edge) {
  const int along = edge / 4;
  const int first = along == 0 ? 1 : 0;
  const int second = along == 2 ? 1 : 2;
  std::array<double, 3> place{};
  place[static_cast<std::size_t>(first)] = (edge & 1) != 0 ? 0.5 : -0.5;
  place[static_cast<std::size_t>(second)] = (edge & 2) != 0 ? 0.5 : -0.5;
  return place;
}

PointPlace placeOf(const Manifold& m, const CornerArray& position, std::size_t point) {
  PointPlace place;
  const BlockFrame upper = blockFrame(position, static_cast<std::size_t>(m.upper));
  if (m.touch == Touch::edge) {
    // The ends of the edges resist least and bound any crossing.
    const BlockFrame lower = blockFrame(position, static_cast<std::size_t>(m.lower));
    const auto alongUpper = static_cast<std::size_t>(m.incidentFace / 4);
    const auto alongLower = static_cast<std::size_t>(m.referenceFace / 4);
    place.upper = edgeMiddle(m.incidentFace);
    place.lower = edgeMiddle(m.referenceFace);
    place.upper[alongUpper] = 0.5;
    place.lower[alongLower] = 0.5;
    place.normal = vectorOf(upper.place.side[alongUpper]).cross(vectorOf(lower.place.side[alongLower])).normalized();
    return place;
  }
  const FaceAxes& face = kFaceAxes[static_cast<std::size_t>(m.incidentFace)];
  place.upper[face.across] = face.side;
  place.upper[face.u] = m.u[point];
  place.upper[face.v] = m.v[point];
  if (m.lower < 0) return place;
  Vec3 at = vectorOf(upper.place.centre);
  for (std::size_t a = 0; a < 3; ++a) at += place.upper[a] * vectorOf(upper.place.side[a]);
  const BlockFrame lower = blockFrame(position, static_cast<std::size_t>(m.lower));
  const FaceAxes& reference = kFaceAxes[static_cast<std::size_t>(m.referenceFace)];
  const Vec3 arm = at - vectorOf(lower.place.centre);
  for (std::size_t a = 0; a < 3; ++a) place.lower[a] = vectorOf(lower.dual[a]).dot(arm);
  place.lower[reference.across] = reference.side;
  place.normal = vectorOf(lower.normal[reference.across]);
  return place;
}

// Weight of a corner in a point of the affine part.
double weightOf(std::size_t corner, const std::array<double, 3>& place) {
  double weight = 0.125;
  for (std::size_t a = 0; a < 3; ++a) weight += 0.25 * cornerSide(corner, a) * place[a];
  return weight;
}

void contactPart(const Simulation& simulation, const Manifold& m, const CornerArray& mode, CornerArray& force) {
  const Settings& settings = simulation.scene.settings;
  const std::vector<std::uint8_t>& asleep = simulation.asleep;
  const auto upper = static_cast<std::size_t>(m.upper);
  const auto lower = static_cast<std::size_t>(std::max(m.lower, 0));
  const bool moveUpper = asleep[upper] == 0;
  const bool moveLower = m.lower >= 0 && asleep[lower] == 0;
  for (std::size_t p = 0; p < static_cast<std::size_t>(m.count); ++p) {
    const PointPlace place = placeOf(m, simulation.state.position, p);
    Vec3 relative = Vec3::Zero();
    for (std::size_t c = 0; c < kCorners; ++c) {
      if (moveUpper) relative += weightOf(c, place.upper) * mode.at(upper, c);
      if (moveLower) relative -= weightOf(c, place.lower) * mode.at(lower, c);
    }
    const Vec3 normalPart = relative.dot(place.normal) * place.normal;
    const double stiffness = (m.lower < 0 ? simulation.floorStiffness_n_m : simulation.contactStiffness_n_m) * m.scale[p];
    const Vec3 f = stiffness * ((1.0 + settings.viscoelasticRatio) * normalPart + settings.tangentialRatio * (relative - normalPart));
    for (std::size_t c = 0; c < kCorners; ++c) {
      if (moveUpper) force.add(upper, c, weightOf(c, place.upper) * f);
      if (moveLower) force.add(lower, c, -weightOf(c, place.lower) * f);
    }
  }
}

}  // namespace

double spectralRadius(Simulation& simulation, std::span<const std::int32_t> blocks, std::span<const std::int32_t> pairs, int iterations) {
  Engine& engine = *simulation.engine;
  const Inertia inertia = simulation.scene.settings.inertia;
  const InverseMass inverse = inverseMass(inertia);
  double radius = 0.0;
  for (int iteration = 0; iteration < iterations; ++iteration) {
    for (const std::int32_t block : blocks) {
      springPart(simulation.model, simulation.state.position, engine.mode, static_cast<std::size_t>(block), engine.force);
    }
    for (const std::int32_t at : pairs) {
      const Manifold& manifold = engine.pairs[static_cast<std::size_t>(at)].manifold;
      if (manifold.touch != Touch::apart) contactPart(simulation, manifold, engine.mode, engine.force);
    }
    double stored = 0.0;
    double moving = 0.0;
    double largest = 0.0;
    for (const std::int32_t block : blocks) {
      const auto b = static_cast<std::size_t>(block);
      const double mass = simulation.model.mass[b];
      moving += mass * massProduct(inertia, engine.mode, engine.mode, b);
      for (std::size_t a = 0; a < 3; ++a) {
        const double* f = engine.force.values(a, b);
        double* d = engine.mode.values(a, b);
        double sum = 0.0;
        for (std::size_t c = 0; c < kCorners; ++c) {
          stored += d[c] * f[c];
          sum += f[c];
        }
        for (std::size_t c = 0; c < kCorners; ++c) {
          d[c] = (inverse.own * f[c] - inverse.shared * sum) / mass;
          largest = std::max(largest, std::abs(d[c]));
        }
      }
    }
    radius = moving > 0.0 ? stored / moving : 0.0;
    if (!(largest > 0.0)) break;
    const double scale = 1.0 / largest;
    for (const std::int32_t block : blocks) {
      for (std::size_t a = 0; a < 3; ++a) {
        double* d = engine.mode.values(a, static_cast<std::size_t>(block));
        for (std::size_t c = 0; c < kCorners; ++c) d[c] *= scale;
      }
    }
  }
  return radius;
}

double blockSpectralRadius(const BlockModel& model, Inertia inertia, std::size_t block) {
  using Matrix24 = Eigen::Matrix<double, 24, 24>;
  const InverseMass inverse = inverseMass(inertia);
  Matrix24 stiffness = Matrix24::Zero();
  for (std::size_t group = 1; group <= kSpringGroups; ++group) {
    for (std::size_t c = 0; c < kCorners; ++c) {
      const std::size_t partner = c ^ group;
      if (partner < c) continue;
      Vec3 along;
      for (std::size_t a = 0; a < 3; ++a) {
        const auto axis = static_cast<Eigen::Index>(a);
        along[axis] = 0.5 * (cornerSide(partner, a) - cornerSide(c, a)) * model.dimensions[block][axis];
      }
      along.normalize();
      const Eigen::Matrix3d part = model.springStiffness[group - 1][block] * along * along.transpose();
      const auto i = static_cast<Eigen::Index>(3 * c);
      const auto j = static_cast<Eigen::Index>(3 * partner);
      stiffness.block<3, 3>(i, i) += part;
      stiffness.block<3, 3>(j, j) += part;
      stiffness.block<3, 3>(i, j) -= part;
      stiffness.block<3, 3>(j, i) -= part;
    }
  }
  // M^-1/2: one factor for the mean of a component, another for what differs from it.
  const double mass = model.mass[block];
  const double mean = std::sqrt((inverse.own - 8.0 * inverse.shared) / mass);
  const double own = std::sqrt(inverse.own / mass);
  Matrix24 root = Matrix24::Zero();
  for (Eigen::Index c = 0; c < 8; ++c) {
    for (Eigen::Index d = 0; d < 8; ++d) {
      for (Eigen::Index a = 0; a < 3; ++a) root(3 * c + a, 3 * d + a) = (mean - own) / 8.0 + (c == d ? own : 0.0);
    }
  }
  const Matrix24 symmetric = root * stiffness * root;
  return Eigen::SelfAdjointEigenSolver<Matrix24>(symmetric, Eigen::EigenvaluesOnly).eigenvalues()[23];
}

std::uint64_t contactSignature(const Engine& engine, std::span<const std::int32_t> pairs) {
  std::uint64_t hash = 1469598103934665603ULL;
  const auto mix = [&](std::uint64_t value) { hash = (hash ^ value) * 1099511628211ULL; };
  for (const std::int32_t at : pairs) {
    const Manifold& m = engine.pairs[static_cast<std::size_t>(at)].manifold;
    if (m.touch == Touch::apart) continue;
    mix(static_cast<std::uint64_t>(at));
    mix(static_cast<std::uint64_t>(m.count) + 16U * static_cast<std::uint64_t>(m.incidentFace) +
        256U * static_cast<std::uint64_t>(m.referenceFace));
    for (std::size_t p = 0; p < static_cast<std::size_t>(m.count); ++p) mix(static_cast<std::uint64_t>(16.0 * std::log2(m.scale[p])));
  }
  return hash;
}

void seedMode(Engine& engine, std::size_t block) {
  std::uint64_t bits = 0x9e3779b97f4a7c15ULL * (static_cast<std::uint64_t>(block) + 1U);
  for (std::size_t a = 0; a < 3; ++a) {
    for (std::size_t c = 0; c < kCorners; ++c) {
      bits ^= bits >> 12U;
      bits ^= bits << 25U;
      bits ^= bits >> 27U;
      engine.mode.values(a, block)[c] = static_cast<double>(static_cast<std::int64_t>(bits * 0x2545f4914f6cdd1dULL)) * 0x1p-63;
    }
  }
}

}  // namespace springtower
