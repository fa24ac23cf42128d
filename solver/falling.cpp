#include "solver/falling.h"

#include "core/lanes.h"
#include "solver/evaluate_contacts.h"
#include "solver/implicit_history.h"
#include "solver/inertia.h"
#include "solver/rigid_frame.h"
#include "solver/stage_clock.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>

namespace springtower {

namespace {

// Tolerance that the contacts of a fall are as soft as, in default ones.
constexpr double kFallTolerance = 2.0;
// Speed at which an island begins to fall, in sqrt(g h), and what is left of it when it no longer does.
constexpr double kFallSpeed = 0.5;
constexpr double kFallenShare = 0.5;
// Blocks of an island that falls, at least: fewer cost little as they are.
constexpr std::size_t kFewest = 3;
// Angle by which a block may turn in a step, rad; and steps of a frame that a free fall takes.
constexpr double kMostTurn = 0.02;
constexpr double kLeastSteps = 24.0;
constexpr std::size_t kGrain = 64;

using Triple = std::array<double, 3>;
using Rows = std::array<Triple, 3>;

SPRINGTOWER_INLINE Triple cross(const Triple& p, const Triple& q) {
  return {p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2], p[0] * q[1] - p[1] * q[0]};
}

SPRINGTOWER_INLINE Triple times(const Rows& m, const Triple& v) {
  Triple result;
  for (std::size_t i = 0; i < 3; ++i) result[i] = m[i][0] * v[0] + m[i][1] * v[1] + m[i][2] * v[2];
  return result;
}

SPRINGTOWER_INLINE Triple transposedTimes(const Rows& m, const Triple& v) {
  Triple result;
  for (std::size_t i = 0; i < 3; ++i) result[i] = m[0][i] * v[0] + m[1][i] * v[1] + m[2][i] * v[2];
  return result;
}

// A vector turned by the rotation whose axis is w and the tangent of half whose angle is |w| (Cayley; Rodrigues).
SPRINGTOWER_INLINE Triple turned(const Triple& w, const Triple& v) {
  const double share = 2.0 / (1.0 + w[0] * w[0] + w[1] * w[1] + w[2] * w[2]);
  const Triple once = cross(w, v);
  const Triple twice = cross(w, once);
  return {v[0] + share * (once[0] + twice[0]), v[1] + share * (once[1] + twice[1]), v[2] + share * (once[2] + twice[2])};
}

SPRINGTOWER_INLINE Triple scaled(double factor, const Triple& v) {
  return {factor * v[0], factor * v[1], factor * v[2]};
}

// Angular velocity for a turn and the momentum, rad/s.
SPRINGTOWER_INLINE Triple spinOf(const FallingBlock& block) {
  return times(block.turn, times(block.inverseMoment, transposedTimes(block.turn, block.momentum)));
}

// Turns the block by its spin in the middle of the step, where the momentum is the same (second order).
SPRINGTOWER_INLINE void turnBlock(FallingBlock& block, double step_s) {
  const Triple quarter = scaled(0.25 * step_s, spinOf(block));
  const Triple back = turned(scaled(-1.0, quarter), block.momentum);
  const Triple own = times(block.inverseMoment, transposedTimes(block.turn, back));
  const Triple half = scaled(0.5 * step_s, turned(quarter, times(block.turn, own)));
  for (std::size_t column = 0; column < 3; ++column) {
    const Triple axis = turned(half, {block.turn[0][column], block.turn[1][column], block.turn[2][column]});
    for (std::size_t i = 0; i < 3; ++i) block.turn[i][column] = axis[i];
  }
}

// The block as the contacts see it.
SPRINGTOWER_INLINE void frameOf(const FallingBlock& block, BlockFrame& frame, AffineField& motion) {
  alignas(32) double vectors[3][12];
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t k = 0; k < 12; ++k) {
      vectors[i][k] = block.turn[i][0] * block.vectors[0][k] + block.turn[i][1] * block.vectors[1][k] +
                      block.turn[i][2] * block.vectors[2][k];
    }
  }
  frame.place.centre = block.centre;
  motion.centre = block.velocity;
  const Triple spin = spinOf(block);
  for (std::size_t a = 0; a < 3; ++a) {
    for (std::size_t i = 0; i < 3; ++i) {
      frame.place.side[a][i] = vectors[i][a];
      frame.dual[a][i] = vectors[i][3 + a];
      frame.normal[a][i] = vectors[i][6 + a];
    }
    motion.side[a] = cross(spin, frame.place.side[a]);
  }
}

SPRINGTOWER_INLINE void writeCorners(const FallingBlock& block, std::size_t b, CornerArray& position) {
  for (std::size_t i = 0; i < 3; ++i) {
    double* x = position.values(i, b);
    for (std::size_t c = 0; c < kCorners; ++c) {
      x[c] = block.centre[i] + (block.turn[i][0] * block.corner[0][c] + block.turn[i][1] * block.corner[1][c] +
                                block.turn[i][2] * block.corner[2][c]);
    }
  }
}

// What forces on a block's affine part do to its velocity and momentum in a time.
SPRINGTOWER_INLINE void pushBlock(FallingBlock& block, const BlockFrame& frame, const AffineField& force, const Vec3& gravity,
                                  double time_s) {
  for (std::size_t a = 0; a < 3; ++a) {
    const Triple torque = cross(frame.place.side[a], force.side[a]);
    for (std::size_t i = 0; i < 3; ++i) block.momentum[i] += time_s * torque[i];
  }
  for (std::size_t i = 0; i < 3; ++i)
    block.velocity[i] += time_s * (block.inverseMass * force.centre[i] + gravity[static_cast<Eigen::Index>(i)]);
}

SPRINGTOWER_KERNEL
void advanceFalling(IslandStep& step, std::span<const std::int32_t> blocks) {
  Engine& engine = step.engine;
  const double kick = step.kick_s;
  const double drift = step.drift_s;
  for (const std::int32_t at : blocks) {
    const auto b = static_cast<std::size_t>(at);
    FallingBlock& block = engine.falling[b];
    const AffineField& force = engine.contactForce[b];
    BlockFrame& frame = engine.frames[b];
    pushBlock(block, frame, force, step.gravity, kick);
    for (std::size_t i = 0; i < 3; ++i) block.centre[i] += drift * block.velocity[i];
    turnBlock(block, drift);
    for (std::size_t i = 0; i < 3; ++i)
      std::copy_n(step.simulation.state.position.values(i, b), kCorners, engine.previous.values(i, b));
    writeCorners(block, b, step.simulation.state.position);
    frameOf(block, frame, engine.motion[b]);
  }
}

void readBlock(IslandStep& step, std::size_t b) {
  const Simulation& simulation = step.simulation;
  FallingBlock& block = step.engine.falling[b];
  const RigidMotion motion = rigidMotion(simulation.state, b);
  const Eigen::Matrix3d axes = straightAxes(simulation.state.position, b);
  const double mass = simulation.model.mass[b];
  block.inverseMass = 1.0 / mass;
  Eigen::Matrix3d moment = Eigen::Matrix3d::Zero();
  for (std::size_t c = 0; c < kCorners; ++c) {
    const Vec3 arm = axes.transpose() * (simulation.state.position.at(b, c) - motion.centre);
    moment += arm.squaredNorm() * Eigen::Matrix3d::Identity() - arm * arm.transpose();
    for (std::size_t i = 0; i < 3; ++i) block.corner[i][c] = arm[static_cast<Eigen::Index>(i)];
  }
  moment *= mass / inverseMass(simulation.scene.settings.inertia).own;
  const Eigen::Matrix3d inverse = moment.inverse();
  const Vec3 momentum = axes * (moment * (axes.transpose() * motion.spin));
  const BlockFrame frame = blockFrame(simulation.state.position, b);
  for (std::size_t i = 0; i < 3; ++i) {
    const auto row = static_cast<Eigen::Index>(i);
    block.centre[i] = motion.centre[row];
    block.velocity[i] = motion.velocity[row];
    block.momentum[i] = momentum[row];
    for (std::size_t k = 0; k < 3; ++k) {
      const auto column = static_cast<Eigen::Index>(k);
      block.turn[i][k] = axes(row, column);
      block.inverseMoment[i][k] = inverse(row, column);
    }
  }
  for (std::size_t a = 0; a < 3; ++a) {
    const Triple side = transposedTimes(block.turn, frame.place.side[a]);
    const Triple dual = transposedTimes(block.turn, frame.dual[a]);
    const Triple normal = transposedTimes(block.turn, frame.normal[a]);
    for (std::size_t i = 0; i < 3; ++i) {
      block.vectors[i][a] = side[i];
      block.vectors[i][3 + a] = dual[i];
      block.vectors[i][6 + a] = normal[i];
    }
  }
  frameOf(block, step.engine.frames[b], step.engine.motion[b]);
}

// Makes the contacts of a pair `factor` times as stiff. What is stiffened pushes as before, from less far; what is softened less,
// from as far.
void changeStiffness(IslandStep& step, NearPair& pair, double factor) {
  Manifold& m = pair.manifold;
  std::array<double, kManifoldPoints> depth{};
  if (factor > 1.0) {
    const AffineField still{};
    const BlockFrame upper = blockFrame(step.simulation.state.position, static_cast<std::size_t>(m.upper));
    const BlockFrame lower = m.lower < 0 ? upper : blockFrame(step.simulation.state.position, static_cast<std::size_t>(m.lower));
    depth = pointForces(m, {&upper, &still, &still}, {m.lower < 0 ? nullptr : &lower, &still, &still}, step.law).depth;
  }
  for (std::size_t i = 0; i < static_cast<std::size_t>(m.count); ++i) {
    const double scale = factor > 1.0 ? std::max(1.0, m.scale[i]) : m.scale[i] * factor;
    const double share = m.scale[i] / scale;
    m.scale[i] = scale;
    if (factor < 1.0) continue;
    m.offset[i] = depth[i] - share * (depth[i] - m.offset[i]);
    m.relaxed[i] *= share;
    m.stretchX[i] *= share;
    m.stretchY[i] *= share;
    m.stretchZ[i] *= share;
  }
}

// Whether the root of the blocks' mean squared speed, by mass, is above this one, in sqrt(g h).
bool isFasterThan(const IslandStep& step, double speed) {
  const Simulation& simulation = step.simulation;
  double mass = 0.0;
  double motion = 0.0;
  for (const std::int32_t block : step.blocks) {
    const auto b = static_cast<std::size_t>(block);
    mass += simulation.model.mass[b];
    motion += simulation.model.mass[b] * centre(simulation.state.velocity, b).squaredNorm();
  }
  const double least = speed * simulation.lengths.blockHeight_m / simulation.lengths.fallTime_s;
  return motion > mass * least * least;
}

template <class Kernel>
void overBlocks(const IslandStep& step, const Kernel& kernel) {
  if (step.blocks.size() < kParallelBlocks) {
    kernel(step.blocks);
    return;
  }
  using Range = tbb::blocked_range<std::size_t>;
  tbb::parallel_for(Range(0, step.blocks.size(), kGrain),
                    [&](const Range& range) { kernel(step.blocks.subspan(range.begin(), range.size())); });
}

}  // namespace

double fallingScale(const Simulation& simulation) {
  const double usual_m = kBlockTolerance_m * (simulation.lengths.blockHeight_m / kBlockHeight_m);
  return std::min(1.0, simulation.tolerance_m / (kFallTolerance * usual_m));
}

bool fallsNow(const IslandStep& step) {
  return step.blocks.size() >= kFewest && fallingScale(step.simulation) < 1.0 && !holdsTether(step) && !isPushed(step) &&
         isFasterThan(step, kFallSpeed);
}

bool fallsOn(const IslandStep& step) {
  const bool fell = std::any_of(step.blocks.begin(), step.blocks.end(),
                                [&](std::int32_t block) { return step.engine.clock[static_cast<std::size_t>(block)].falls; });
  return fell && step.blocks.size() >= kFewest && !holdsTether(step) && !isPushed(step) &&
         isFasterThan(step, kFallSpeed * kFallenShare);
}

void setFalling(IslandStep& step, bool falling) {
  std::vector<BlockClock>& clock = step.engine.clock;
  const double scale = fallingScale(step.simulation);
  const bool fell = std::any_of(step.blocks.begin(), step.blocks.end(),
                                [&](std::int32_t block) { return clock[static_cast<std::size_t>(block)].falls; });
  if (!fell && !falling) return;
  if (!falling) synchronise(step);
  if (!fell) {
    step.gravity = step.simulation.scene.gravity.at(step.simulation.time_s);
    synchronise(step);
  }
  for (const std::int32_t at : step.pairs) {
    NearPair& pair = step.engine.pairs[static_cast<std::size_t>(at)];
    if (pair.manifold.touch == Touch::apart) continue;
    const bool soft =
        clock[static_cast<std::size_t>(pair.a)].falls || (pair.b >= 0 && clock[static_cast<std::size_t>(pair.b)].falls);
    if (soft != falling) changeStiffness(step, pair, falling ? scale : 1.0 / scale);
  }
  for (const std::int32_t block : step.blocks) clock[static_cast<std::size_t>(block)].falls = falling;
  step.law.restingScale = falling ? scale : 1.0;
  step.law.longSteps = falling;
}

int beginFall(IslandStep& step) {
  StageClock clock(step.times);
  overBlocks(step, [&](std::span<const std::int32_t> blocks) {
    for (const std::int32_t block : blocks) readBlock(step, static_cast<std::size_t>(block));
  });
  double fastest = 0.0;
  for (const std::int32_t block : step.blocks) {
    const Triple spin = spinOf(step.engine.falling[static_cast<std::size_t>(block)]);
    fastest = std::max(fastest, spin[0] * spin[0] + spin[1] * spin[1] + spin[2] * spin[2]);
  }
  clock.lap(Stage::integration);
  return static_cast<int>(
      std::ceil(std::max(kLeastSteps, std::sqrt(fastest) * step.simulation.scene.settings.frame_s / kMostTurn)));
}

void stepFall(IslandStep& step) {
  StageClock clock(step.times);
  evaluateContacts(step, step.advance_s, step.kick_s);
  clock.lap(Stage::contacts);
  overBlocks(step, [&](std::span<const std::int32_t> blocks) { advanceFalling(step, blocks); });
  clock.lap(Stage::integration);
}

void endFall(IslandStep& step) {
  for (const std::int32_t at : step.blocks) {
    const auto b = static_cast<std::size_t>(at);
    const FallingBlock& block = step.engine.falling[b];
    const Triple spin = spinOf(block);
    for (std::size_t c = 0; c < kCorners; ++c) {
      const Vec3 place = step.simulation.state.position.at(b, c);
      const Triple arm = {place.x() - block.centre[0], place.y() - block.centre[1], place.z() - block.centre[2]};
      const Triple turning = cross(spin, arm);
      step.simulation.state.velocity.set(
          b, c, Vec3(block.velocity[0] + turning[0], block.velocity[1] + turning[1], block.velocity[2] + turning[2]));
    }
  }
}

void synchroniseFall(IslandStep& step) {
  double behind_s = 0.0;
  for (const std::int32_t block : step.blocks)
    behind_s = std::max(behind_s, step.engine.clock[static_cast<std::size_t>(block)].lastDrift_s);
  step.law.restingScale = fallingScale(step.simulation);
  step.law.longSteps = true;
  beginFall(step);
  evaluateContacts(step, behind_s, behind_s);
  const Vec3 gravity = step.simulation.scene.gravity.at(step.simulation.time_s);
  for (const std::int32_t at : step.blocks) {
    const auto b = static_cast<std::size_t>(at);
    BlockClock& clock = step.engine.clock[b];
    pushBlock(step.engine.falling[b], step.engine.frames[b], step.engine.contactForce[b], gravity, 0.5 * clock.lastDrift_s);
    clock.lastDrift_s = 0.0;
  }
  endFall(step);
}

}  // namespace springtower
