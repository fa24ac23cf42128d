#include "solver/block/springs.h"

#include "core/elementary.h"
#include "core/lanes.h"
#include "core/tuning.h"
#include "solver/block/modes.h"

#include <algorithm>
#include <cmath>

namespace springtower {

namespace {

// The force lanes of four springs of one group: pulls `first` corners towards `second` ones.
struct Pull {
  Lanes x, y, z;
};

SPRINGTOWER_INLINE void pull(const Lanes* p, const Lanes* q, const Lanes* vp, const Lanes* vq, double restLength,
                             double stiffness, double damping, Pull& result) {
  const Lanes dx = q[0] - p[0];
  const Lanes dy = q[1] - p[1];
  const Lanes dz = q[2] - p[2];
  const Lanes squared = dx * dx + dy * dy + dz * dz;
  Lanes length;
  squareRoot(squared, length);
  const Lanes inverse = 1.0 / length;
  const Lanes rate = ((vq[0] - vp[0]) * dx + (vq[1] - vp[1]) * dy + (vq[2] - vp[2]) * dz) * inverse;
  const Lanes along = (stiffness * (length - restLength) + damping * rate) * inverse;
  result.x = along * dx;
  result.y = along * dy;
  result.z = along * dz;
}

// Springs within the lower and upper halves (groups 1, 2, 3): four first corners and their four partners.
template <int P0, int P1, int P2, int P3, int Q0, int Q1, int Q2, int Q3>
SPRINGTOWER_INLINE void pullWithinHalves(const Lanes* low, const Lanes* high, const Lanes* vlow, const Lanes* vhigh,
                                         double restLength, double stiffness, double damping, Lanes* first, Lanes* second) {
  Lanes p[3], q[3], vp[3], vq[3];
  for (int a = 0; a < 3; ++a) {
    shuffle<P0, P1, P2, P3>(low[a], high[a], p[a]);
    shuffle<Q0, Q1, Q2, Q3>(low[a], high[a], q[a]);
    shuffle<P0, P1, P2, P3>(vlow[a], vhigh[a], vp[a]);
    shuffle<Q0, Q1, Q2, Q3>(vlow[a], vhigh[a], vq[a]);
  }
  Pull f;
  pull(p, q, vp, vq, restLength, stiffness, damping, f);
  first[0] = f.x;
  first[1] = f.y;
  first[2] = f.z;
  for (int a = 0; a < 3; ++a) second[a] = -first[a];
}

// Springs between the halves (groups 4 to 7): lower corner i with upper corner 4 + (i xor X).
template <int X>
SPRINGTOWER_INLINE void pullBetweenHalves(const Lanes* low, const Lanes* high, const Lanes* vlow, const Lanes* vhigh,
                                          double restLength, double stiffness, double damping, Lanes* forceLow,
                                          Lanes* forceHigh) {
  Lanes q[3], vq[3];
  for (int a = 0; a < 3; ++a) {
    shuffle<0 ^ X, 1 ^ X, 2 ^ X, 3 ^ X>(high[a], high[a], q[a]);
    shuffle<0 ^ X, 1 ^ X, 2 ^ X, 3 ^ X>(vhigh[a], vhigh[a], vq[a]);
  }
  Pull f;
  pull(low, q, vlow, vq, restLength, stiffness, damping, f);
  const Lanes component[3] = {f.x, f.y, f.z};
  for (int a = 0; a < 3; ++a) {
    Lanes back;
    shuffle<0 ^ X, 1 ^ X, 2 ^ X, 3 ^ X>(component[a], component[a], back);
    forceLow[a] += component[a];
    forceHigh[a] -= back;
  }
}

SPRINGTOWER_INLINE void blockSprings(const BlockModel& model, const MotionState& state, std::size_t b, const AffineField& contact,
                                     ParticleArray& force) {
  Lanes low[3], high[3], vlow[3], vhigh[3], forceLow[3], forceHigh[3];
  for (std::size_t a = 0; a < 3; ++a) {
    load(state.position.values(a, b), low[a]);
    load(state.position.values(a, b) + 4, high[a]);
    load(state.velocity.values(a, b), vlow[a]);
    load(state.velocity.values(a, b) + 4, vhigh[a]);
  }
  const auto rest = [&](std::size_t group) { return model.restLength[group - 1][b]; };
  const auto stiff = [&](std::size_t group) { return model.springStiffness[group - 1][b]; };
  const auto damp = [&](std::size_t group) { return model.springDamping[group - 1][b]; };

  Lanes first[3], second[3];
  // x: 0-1 2-3 4-5 6-7
  pullWithinHalves<0, 2, 4, 6, 1, 3, 5, 7>(low, high, vlow, vhigh, rest(1), stiff(1), damp(1), first, second);
  for (int a = 0; a < 3; ++a) {
    shuffle<0, 4, 1, 5>(first[a], second[a], forceLow[a]);
    shuffle<2, 6, 3, 7>(first[a], second[a], forceHigh[a]);
  }
  // y: 0-2 1-3 4-6 5-7
  pullWithinHalves<0, 1, 4, 5, 2, 3, 6, 7>(low, high, vlow, vhigh, rest(2), stiff(2), damp(2), first, second);
  for (int a = 0; a < 3; ++a) {
    Lanes part;
    shuffle<0, 1, 4, 5>(first[a], second[a], part);
    forceLow[a] += part;
    shuffle<2, 3, 6, 7>(first[a], second[a], part);
    forceHigh[a] += part;
  }
  // xy: 0-3 1-2 4-7 5-6
  pullWithinHalves<0, 1, 4, 5, 3, 2, 7, 6>(low, high, vlow, vhigh, rest(3), stiff(3), damp(3), first, second);
  for (int a = 0; a < 3; ++a) {
    Lanes part;
    shuffle<0, 1, 5, 4>(first[a], second[a], part);
    forceLow[a] += part;
    shuffle<2, 3, 7, 6>(first[a], second[a], part);
    forceHigh[a] += part;
  }
  pullBetweenHalves<0>(low, high, vlow, vhigh, rest(4), stiff(4), damp(4), forceLow, forceHigh);
  pullBetweenHalves<1>(low, high, vlow, vhigh, rest(5), stiff(5), damp(5), forceLow, forceHigh);
  pullBetweenHalves<2>(low, high, vlow, vhigh, rest(6), stiff(6), damp(6), forceLow, forceHigh);
  pullBetweenHalves<3>(low, high, vlow, vhigh, rest(7), stiff(7), damp(7), forceLow, forceHigh);
  // Contact forces on each corner have its weight in the affine part: 1/8 + sum s_a xi_a / 4.
  for (std::size_t a = 0; a < 3; ++a) {
    const Lanes sideX = {-1.0, 1.0, -1.0, 1.0};
    const Lanes sideY = {-1.0, -1.0, 1.0, 1.0};
    const Lanes level = 0.125 * contact.centre[a] + 0.25 * (sideX * contact.side[0][a] + sideY * contact.side[1][a]);
    const double upwards = 0.25 * contact.side[2][a];
    forceLow[a] += level - upwards;
    forceHigh[a] += level + upwards;
    store(forceLow[a], force.values(a, b));
    store(forceHigh[a], force.values(a, b) + 4);
  }
}

// Forces of a block's warps: each pattern of corners by its part of the positions and velocities.
SPRINGTOWER_INLINE void addWarpForces(const BlockModel& model, const MotionState& state, std::size_t b, ParticleArray& force) {
  using namespace block_modes;
  const double stiffness = model.warpStiffness[b] / 64.0;
  const double damping = stiffness * model.springDamping[0][b] / model.springStiffness[0][b];
  for (std::size_t a = 0; a < 3; ++a) {
    double place[kCorners], rate[kCorners];
    transform(state.position.values(a, b), place);
    transform(state.velocity.values(a, b), rate);
    double* f = force.values(a, b);
    for (std::size_t m = kAffine; m < kCorners; ++m) {
      const std::size_t pattern = kPattern[m];
      const double resists = stiffness * place[pattern] + damping * rate[pattern];
      for (std::size_t c = 0; c < kCorners; ++c) f[c] -= sign(c, pattern) * resists;
    }
  }
}

// Energy of warps, J.
template <class Place>
double energyOfWarps(const BlockModel& model, Place place, std::size_t block) {
  using namespace block_modes;
  const double stiffness = model.warpStiffnessOf(block);
  if (stiffness == 0.0) return 0.0;
  double squared = 0.0;
  for (std::size_t m = kAffine; m < kCorners; ++m) {
    Vec3 warp = Vec3::Zero();
    for (std::size_t c = 0; c < kCorners; ++c) warp += sign(c, kPattern[m]) / 8.0 * place(c);
    squared += warp.squaredNorm();
  }
  return 0.5 * stiffness * squared;
}

// Calls `visit(group, length)` for each spring of a block whose corners are at `place(corner)`.
template <class Place, class Visit>
void forEachSpring(Place place, Visit visit) {
  for (std::size_t group = 1; group <= kSpringGroups; ++group) {
    for (std::size_t corner = 0; corner < kCorners; ++corner) {
      const std::size_t partner = corner ^ group;
      if (partner > corner) visit(group - 1, (place(partner) - place(corner)).norm());
    }
  }
}

template <class Place>
double energyOfSprings(const BlockModel& model, Place place, std::size_t block) {
  double energy = 0.0;
  forEachSpring(place, [&](std::size_t group, double length) {
    const double change = length - model.restLength[group][block];
    energy += 0.5 * model.springStiffness[group][block] * change * change;
  });
  return energy + energyOfWarps(model, place, block);
}

}  // namespace

SPRINGTOWER_KERNEL
void springForces(const BlockModel& model, const MotionState& state, std::span<const std::int32_t> blocks,
                  std::span<const AffineField> contactForce, ParticleArray& force) {
  for (const std::int32_t block : blocks) {
    const auto b = static_cast<std::size_t>(block);
    blockSprings(model, state, b, contactForce[b], force);
    if (model.warpStiffnessOf(b) > 0.0) addWarpForces(model, state, b, force);
  }
}

double springEnergy(const BlockModel& model, const ParticleArray& position, std::size_t block) {
  return energyOfSprings(
      model, [&](std::size_t c) { return position.at(block, c); }, block);
}

double springEnergy(const BlockModel& model, const OwnCorners& corner, std::size_t block) {
  return energyOfSprings(
      model, [&](std::size_t c) { return Vec3(corner[0][c], corner[1][c], corner[2][c]); }, block);
}

double springStrain(const BlockModel& model, const ParticleArray& position, std::size_t block) {
  double strain = 0.0;
  const auto place = [&](std::size_t c) { return position.at(block, c); };
  forEachSpring(place, [&](std::size_t group, double length) {
    strain = std::max(strain, std::abs(length / model.restLength[group][block] - 1.0));
  });
  return strain;
}

void setSprings(BlockModel& model, std::size_t block, double stiffness_n_m, double referenceLength_m, double dampingTime_s) {
  const Vec3& size = model.dimensions[block];
  for (std::size_t group = 1; group <= kSpringGroups; ++group) {
    double squared = 0.0;
    for (std::size_t a = 0; a < 3; ++a) {
      const double side = size[static_cast<Eigen::Index>(a)];
      if (((group >> a) & 1U) != 0U) squared += side * side;
    }
    const double length = std::sqrt(squared);
    model.restLength[group - 1][block] = length;
    model.springStiffness[group - 1][block] = stiffness_n_m * referenceLength_m / length;
    model.springDamping[group - 1][block] = dampingTime_s * model.springStiffness[group - 1][block];
  }
}

void setWarpStiffness(BlockModel& model, std::size_t block, double load_n) {
  const Vec3& size = model.dimensions[block];
  double lacking = 0.0;
  for (std::size_t a = 0; a < 3; ++a) {
    const std::size_t b = (a + 1) % 3;
    const std::size_t c = (a + 2) % 3;
    const double squareB = elementary::square(size[static_cast<Eigen::Index>(b)]);
    const double squareC = elementary::square(size[static_cast<Eigen::Index>(c)]);
    const auto ofFace = [&](std::size_t across) {
      const std::size_t group = ((std::size_t{1} << a) | (std::size_t{1} << across)) - 1;
      return model.springStiffness[group][block] / elementary::square(model.restLength[group][block]);
    };
    // Of the energy of an angle, half times its square.
    const double springs = squareB * squareC * (ofFace(b) + ofFace(c));
    const double needed = 0.25 * tuning::kTwistSafety * load_n * std::sqrt(std::max(squareB, squareC));
    lacking = std::max(lacking, 16.0 * (needed - springs) / (squareB + squareC));
  }
  if (lacking == 0.0 && model.warpStiffness.empty()) return;
  model.warpStiffness.resize(model.blockCount(), 0.0);
  model.warpStiffness[block] = lacking;
}

Eigen::Matrix<double, 24, 24> springStiffnessMatrix(const BlockModel& model, std::size_t block) {
  Eigen::Matrix<double, 24, 24> stiffness = Eigen::Matrix<double, 24, 24>::Zero();
  const Vec3& size = model.dimensions[block];
  for (std::size_t group = 1; group <= kSpringGroups; ++group) {
    for (std::size_t p = 0; p < kCorners; ++p) {
      const std::size_t q = p ^ group;
      if (q < p) continue;
      Vec3 along;
      for (std::size_t a = 0; a < 3; ++a) {
        const auto axis = static_cast<Eigen::Index>(a);
        along[axis] = 0.5 * (cornerSide(q, a) - cornerSide(p, a)) * size[axis];
      }
      along.normalize();
      const Eigen::Matrix3d k = model.springStiffness[group - 1][block] * along * along.transpose();
      const auto i = static_cast<Eigen::Index>(3 * p);
      const auto j = static_cast<Eigen::Index>(3 * q);
      stiffness.block<3, 3>(i, i) += k;
      stiffness.block<3, 3>(j, j) += k;
      stiffness.block<3, 3>(i, j) -= k;
      stiffness.block<3, 3>(j, i) -= k;
    }
  }
  for (std::size_t p = 0; p < kCorners; ++p) {
    for (std::size_t q = 0; q < kCorners; ++q) {
      double both = 0.0;
      for (std::size_t m = kAffine; m < kCorners; ++m)
        both += block_modes::sign(p, block_modes::kPattern[m]) * block_modes::sign(q, block_modes::kPattern[m]);
      for (Eigen::Index a = 0; a < 3; ++a) {
        stiffness(static_cast<Eigen::Index>(3 * p) + a, static_cast<Eigen::Index>(3 * q) + a) +=
            model.warpStiffnessOf(block) / 64.0 * both;
      }
    }
  }
  return stiffness;
}

}  // namespace springtower
