#include "solver/trials.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace springtower {
namespace {

constexpr double kQuickShare = 0.9;  // of what friction bears: reached in kQuickTime_s, then slowly
constexpr double kQuickTime_s = 1.5;
constexpr double kSlowShare_s = 0.03;
constexpr double kMostShare = 1.5;

double friction_n(const Simulation& simulation, double normal_n) {
  return simulation.scene.staticFriction * normal_n;
}

// A force through the coming frame and no further.
UserForce forceNow(const Simulation& simulation, std::size_t block, const Vec3& force) {
  const double now = simulation.time_s;
  return {static_cast<int>(block), -1, force, now, now + 1.5 * simulation.scene.settings.frame_s};
}

}  // namespace

Scene scaled(Scene scene, double size, double density) {
  for (BlockSpec& block : scene.blocks) {
    block.centre *= size;
    block.dimensions *= size;
    block.mass *= size * size * size * density;
  }
  scene.settings.frame_s *= std::sqrt(size);
  scene.seconds *= std::sqrt(size);
  return scene;
}

double normalForceOn(const std::vector<ContactForce>& forces, BlockId block, bool fromAboveOnly) {
  double sum = 0.0;
  for (const ContactForce& force : forces) {
    const bool below = force.lower == block;
    const bool above = force.upper == block;
    // A contact's upper block need not be the one that lies higher: side by side either may be.
    const bool fromAbove = (below && force.normal.z() > 0.5) || (above && force.normal.z() < -0.5);
    if ((below || above) && (!fromAboveOnly || fromAbove)) sum += force.normalForce;
  }
  return sum;
}

SlipTrial pullUntilSlip(Simulation& simulation, std::size_t block, const Vec3& direction) {
  const BlockId id = blockId(block);
  const double slip_m = kFirstSlip_m / kBlockHeight_m * simulation.lengths.blockHeight_m;
  const auto along = [&](std::size_t b) { return centre(simulation.state.position, b).dot(direction); };
  std::vector<ContactForce> forces = contactForces(simulation);
  SlipTrial trial;
  trial.normal_n = normalForceOn(forces, id, false);
  const double borne_n = friction_n(simulation, trial.normal_n);

  const double start = along(block);
  std::vector<std::pair<BlockId, double>> partners;  // and where they were
  for (const ContactForce& force : forces) {
    if (force.upper != id && force.lower != id) continue;
    const BlockId other = force.upper == id ? force.lower : force.upper;
    partners.emplace_back(other, other == kFloor ? 0.0 : along(index(other)));
  }
  const auto slip = [&] {
    double least = std::numeric_limits<double>::infinity();
    for (const auto& [other, before] : partners) {
      const double moved = other == kFloor ? 0.0 : along(index(other)) - before;
      least = std::min(least, along(block) - start - moved);
    }
    return least;
  };

  const double begin_s = simulation.time_s;
  while (!trial.slipped) {
    trial.time_s = simulation.time_s + simulation.scene.settings.frame_s - begin_s;
    const double share = trial.time_s < kQuickTime_s ? kQuickShare * trial.time_s / kQuickTime_s
                                                     : kQuickShare + kSlowShare_s * (trial.time_s - kQuickTime_s);
    if (share > kMostShare) break;
    trial.force_n = share * borne_n;
    simulation.scene.forces = {forceNow(simulation, block, trial.force_n * direction)};
    const double normal_n = normalForceOn(contactForces(simulation), id, false);
    stepFrame(simulation);
    trial.slipped = slip() > slip_m;
    trial.normal_n = normal_n;
  }
  simulation.scene.forces.clear();
  return trial;
}

TiltTrial tiltUntilFall(Scene scene, const TiltRamp& ramp) {
  scene.gravity.tilt_deg = ramp.most_deg;  // stiff enough for the loads of the farthest lean, not only upright
  scene.gravity.direction_deg = ramp.direction_deg;
  Simulation simulation(scene);
  simulation.scene.gravity.tilt_deg = 0.0;
  const std::vector<FittedBox> start = fittedBoxes(simulation.state.position);
  TiltTrial trial;
  while (trial.standing.stands && simulation.scene.gravity.tilt_deg < ramp.most_deg) {
    const double next_s = simulation.time_s + scene.settings.frame_s;
    const double slow_s = ramp.start_deg / ramp.approach_deg_s + ramp.hold_s;  // when the slow turn begins
    simulation.scene.gravity.tilt_deg = next_s > slow_s ? ramp.start_deg + ramp.rate_deg_s * (next_s - slow_s)
                                                        : std::min(ramp.start_deg, ramp.approach_deg_s * next_s);
    stepFrame(simulation);
    trial.standing = standing(simulation.model, start, simulation.state.position);
  }
  trial.fell = !trial.standing.stands;
  trial.tilt_deg = simulation.scene.gravity.tilt_deg;
  return trial;
}

}  // namespace springtower
