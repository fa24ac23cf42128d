#include "solver/runner/trials.h"

#include "core/tuning.h"
#include "solver/block/inertia.h"
#include "solver/frame/inputs.h"
#include "solver/frame/prepare.h"
#include "solver/statics/friction_limit.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

namespace springtower {
namespace {

double friction_n(const Simulation& simulation, double normal_n) {
  return simulation.scene.staticFriction * normal_n;
}

// Position of a point of a block, given in shares of its edges from its centre.
Vec3 placeOn(const ParticleArray& position, std::size_t block, const Vec3& shares) {
  return centre(position, block) + meanEdges(position, block) * shares;
}

Vec3 sharesOf(const ParticleArray& position, std::size_t block, const Vec3& place) {
  return meanEdges(position, block).inverse() * (place - centre(position, block));
}

// Contact of a block with another: the centre of pressure, in the coordinates of either. On the floor it is a position.
struct InterfacePoint {
  BlockId other;
  Vec3 onBlock;
  Vec3 onOther;
};

std::vector<InterfacePoint> interfacesOf(const Simulation& simulation, const std::vector<ContactForce>& forces, BlockId block) {
  struct Pressure {
    double normal_n = 0.0;
    Vec3 moment = Vec3::Zero();
  };
  std::map<BlockId, Pressure> pressures;
  for (const ContactForce& force : forces) {
    if ((force.upper != block && force.lower != block) || !(force.normalForce > 0.0)) continue;
    Pressure& pressure = pressures[force.upper == block ? force.lower : force.upper];
    pressure.normal_n += force.normalForce;
    pressure.moment += force.normalForce * force.point;
  }
  const ParticleArray& position = simulation.state.position;
  std::vector<InterfacePoint> interfaces;
  for (const auto& [other, pressure] : pressures) {
    const Vec3 place = pressure.moment / pressure.normal_n;
    interfaces.push_back(
        {other, sharesOf(position, index(block), place), other == kFloor ? place : sharesOf(position, index(other), place)});
  }
  return interfaces;
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
    // The upper block of a contact need not be the higher one: side by side it may be either.
    const bool fromAbove = (below && force.normal.z() > 0.5) || (above && force.normal.z() < -0.5);
    if ((below || above) && (!fromAboveOnly || fromAbove)) sum += force.normalForce;
  }
  return sum;
}

SlipTrial pullUntilSlip(Simulation& simulation, std::size_t block, const Vec3& direction,
                        const std::function<void()>& afterFrame) {
  const BlockId id = blockId(block);
  const double slip_m = kFirstSlip_m / kBlockHeight_m * simulation.lengths.blockHeight_m;
  const std::vector<ContactForce> forces = contactForces(simulation);
  SlipTrial trial;
  trial.normal_n = normalForceOn(forces, id, false);
  const double borne_n = friction_n(simulation, trial.normal_n);

  const std::vector<InterfacePoint> interfaces = interfacesOf(simulation, forces, id);
  const auto slip = [&] {
    double least = std::numeric_limits<double>::infinity();
    for (const InterfacePoint& seam : interfaces) {
      const Vec3 other =
          seam.other == kFloor ? seam.onOther : placeOn(simulation.state.position, index(seam.other), seam.onOther);
      least = std::min<double>(least, (placeOn(simulation.state.position, block, seam.onBlock) - other).dot(direction));
    }
    return least;
  };

  const double begin_s = simulation.time_s;
  while (!trial.slipped) {
    trial.time_s = simulation.time_s + simulation.scene.settings.frame_s - begin_s;
    const double share =
        trial.time_s < tuning::kSlipRampQuickTime_s
            ? tuning::kSlipRampQuickShare * trial.time_s / tuning::kSlipRampQuickTime_s
            : tuning::kSlipRampQuickShare + tuning::kSlipRampSlowRate_per_s * (trial.time_s - tuning::kSlipRampQuickTime_s);
    if (share > tuning::kMaxSlipRampShare) break;
    trial.force_n = share * borne_n;
    setOnlyForce(simulation, forceForOneFrame(simulation, block, trial.force_n * direction));
    const std::vector<ContactForce> before = contactForces(simulation);
    stepFrame(simulation);
    if (afterFrame) afterFrame();
    trial.normal_n = normalForceOn(before, id, false);
    trial.slipped = slip() > slip_m;
    if (trial.slipped) trial.limit_n = frictionLimit_n(simulation, before, id, direction);
  }
  clearForces(simulation);
  return trial;
}

TiltTrial tiltUntilFall(Scene scene, const TiltRamp& ramp, const std::function<void()>& afterFrame,
                        const PrepareOptions& search) {
  scene.gravity.tilt_deg = ramp.most_deg;  // stiff enough for the loads at the largest tilt, not only upright
  scene.gravity.direction_deg = ramp.direction_deg;
  Simulation simulation(scene);
  Gravity gravity = scene.gravity;
  gravity.tilt_deg = 0.0;
  setGravity(simulation, gravity);
  prepare(simulation, search);
  if (afterFrame) afterFrame();
  const std::vector<FittedBox> start = fittedBoxes(simulation.state.position);
  TiltTrial trial;
  while (trial.standing.stands && gravity.tilt_deg < ramp.most_deg) {
    const double next_s = simulation.time_s + scene.settings.frame_s;
    const double slow_s = ramp.start_deg / ramp.approach_deg_s + ramp.hold_s;  // start of the slow rotation
    gravity.tilt_deg = next_s > slow_s ? ramp.start_deg + ramp.rate_deg_s * (next_s - slow_s)
                                       : std::min(ramp.start_deg, ramp.approach_deg_s * next_s);
    setGravity(simulation, gravity);
    stepFrame(simulation);
    if (afterFrame) afterFrame();
    trial.standing = standing(simulation.model, start, simulation.state.position);
  }
  trial.fell = !trial.standing.stands;
  trial.tilt_deg = gravity.tilt_deg;
  return trial;
}

}  // namespace springtower
