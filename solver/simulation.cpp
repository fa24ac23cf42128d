#include "solver/simulation.h"

#include "core/error.h"
#include "core/hash.h"
#include "solver/choose_method.h"
#include "solver/engine.h"
#include "solver/implicit.h"
#include "solver/inertia.h"
#include "solver/near_pairs.h"
#include "solver/rest.h"
#include "solver/rigid_frame.h"
#include "solver/spring_force.h"
#include "solver/stability.h"
#include "solver/stiffness.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace springtower {

namespace {

void placeBlock(const BlockSpec& spec, std::size_t b, Simulation& simulation) {
  simulation.model.dimensions[b] = spec.dimensions;
  simulation.model.mass[b] = spec.mass;
  for (std::size_t c = 0; c < kCorners; ++c) {
    Vec3 arm;
    for (std::size_t a = 0; a < 3; ++a) {
      const auto axis = static_cast<Eigen::Index>(a);
      arm[axis] = 0.5 * cornerSide(c, a) * spec.dimensions[axis];
    }
    arm = spec.orientation * arm;
    simulation.state.position.set(b, c, spec.centre + arm);
    simulation.state.velocity.set(b, c, spec.velocity + spec.spin.cross(arm));
  }
}

// Largest eigenvalue of M^-1 K, 1/s2, that any contact set of this scene is expected to reach with a stiffness: the stiffest
// block's springs, and contacts that press a block from both sides against neighbours that give way as easily.
double foreseenSpectralRadius(const Simulation& simulation, const Stiffness& stiffness) {
  const Settings& settings = simulation.scene.settings;
  BlockModel model = simulation.model;
  double springs = 0.0;
  double lightest = 1e300;
  for (std::size_t b = 0; b < model.blockCount(); ++b) {
    const bool asBefore = b > 0 && model.dimensions[b] == model.dimensions[b - 1] && model.mass[b] == model.mass[b - 1];
    lightest = std::min(lightest, model.mass[b]);
    if (asBefore) continue;
    setSprings(model, b, stiffness.spring_n_m, simulation.lengths.blockHeight_m, 0.0);
    springs = std::max(springs, blockSpectralRadius(model, settings.inertia, b));
  }
  constexpr double kPointsPerSide = 12.0;  // three neighbours of four points
  const double compressionMass =
      inverseMass(settings.inertia).own / 2.0;  // 1/m times this, of the mode that presses a block flat
  const double contact =
      std::max(2.0 * kPointsPerSide * stiffness.contact_n_m, 4.0 * stiffness.floor_n_m) / 4.0 * 2.0 * compressionMass;
  return springs + (1.0 + settings.viscoelasticRatio) * contact / lightest;
}

// Tolerance to stiffness to substeps, or the other way round (design section 2). Stiffness goes as one over the tolerance, the
// square of the steps as the stiffness.
void chooseStiffness(Simulation& simulation) {
  const Settings& settings = simulation.scene.settings;
  LoadEstimate loads = estimateLoads(simulation.scene);
  const bool stable = isImplicit(settings.method) || isRigid(settings.method);  // with any step
  simulation.fixedSubsteps = stable ? 0 : settings.substeps;
  simulation.tolerance_m = toleranceOf(simulation.scene);
  Stiffness stiffness = stiffnessForTolerance(loads, simulation.tolerance_m);
  if (simulation.fixedSubsteps > 0) {
    const double allowed = stableSpectralRadius(settings.method, settings.frame_s / settings.substeps, simulation.dampingTime_s,
                                                settings.stepMargin);
    const double needed = foreseenSpectralRadius(simulation, stiffness);
    if (!settings.tolerance_m) {
      loads.swayStiffness_n_m = 0.0;
      const double unit = foreseenSpectralRadius(simulation, stiffnessForTolerance(loads, 1.0));
      simulation.tolerance_m = unit / allowed;
      stiffness = stiffnessForTolerance(loads, simulation.tolerance_m);
    } else if (needed > allowed && !settings.forceUnstable) {
      throw InputError(fmt::format(
          "settings: found tolerance_m = {:g} with substeps = {}, allowed: at least {} substeps for this tolerance, or "
          "force_unstable",
          *settings.tolerance_m, settings.substeps,
          static_cast<int>(
              std::ceil(settings.frame_s / stableStep(settings.method, needed, simulation.dampingTime_s, settings.stepMargin)))));
    }
  }
  simulation.contactStiffness_n_m = stiffness.contact_n_m;
  simulation.floorStiffness_n_m = stiffness.floor_n_m;
  simulation.springStiffness_n_m = settings.springRatio * stiffness.spring_n_m;
}

}  // namespace

Simulation::Simulation(const Scene& given) : scene(given), engine(std::make_unique<Engine>()) {
  checkScene(scene, scene.name);
  if (scene.settings.method == Method::automatic) scene.settings = chooseMethod(scene);
  const std::size_t count = scene.blocks.size();
  model.dimensions.resize(count);
  model.mass.resize(count);
  for (std::size_t g = 0; g < kSpringGroups; ++g) {
    model.restLength[g].resize(count);
    model.springStiffness[g].resize(count);
    model.springDamping[g].resize(count);
  }
  state.resize(count);
  asleep.assign(count, 0);
  restTime_s.assign(count, 0.0);
  for (std::size_t b = 0; b < count; ++b) placeBlock(scene.blocks[b], b, *this);
  lengths.blockHeight_m = blockHeightOf(scene);
  lengths.fallTime_s =
      std::sqrt(lengths.blockHeight_m / (scene.gravity.magnitude > 0.0 ? scene.gravity.magnitude : kStandardGravity_m_s2));
  dampingTime_s = scene.settings.dampingTime * lengths.fallTime_s;
  lengths.contactError_m = kBornError * lengths.blockHeight_m;
  lengths.partingGap_m = kPartingGap * lengths.blockHeight_m;
  chooseStiffness(*this);
  for (std::size_t b = 0; b < count; ++b) setSprings(model, b, springStiffness_n_m, lengths.blockHeight_m, dampingTime_s);

  Engine& e = *engine;
  e.boxes.resize(count);
  e.reach.assign(count, 0.0);
  e.path.assign(count, 0.0);
  e.foreseenPath.assign(count, 0.0);
  e.travelAtSweep.assign(count, 0.0);
  e.force.resize(count);
  e.frames.resize(count);
  e.motion.resize(count);
  e.contactForce.resize(count);
  e.contactMetric.resize(count);
  e.springRadius.resize(count);
  e.previous = state.position;
  e.clock.assign(count, BlockClock{});
  e.rest.resize(count);
  e.beginning.assign(count, 0);
  e.awakeCount = count;
  for (std::size_t b = 0; b < count; ++b) {
    const bool asBefore =
        b > 0 && scene.blocks[b].dimensions == scene.blocks[b - 1].dimensions && model.mass[b] == model.mass[b - 1];
    e.springRadius[b] = asBefore ? e.springRadius[b - 1] : blockSpectralRadius(model, scene.settings.inertia, b);
    e.rest[b].centre = centre(state.position, b);
  }
  if (scene.settings.method == Method::report) {
    e.report.resize(count);
  } else if (isRigid(scene.settings.method)) {
    prepareRigid(*this);
  } else {
    prepareImplicit(*this);  // explicit methods start in the equilibrium that implicit steps find
  }
  if (scene.settings.method == Method::midpoint || scene.settings.method == Method::rungeKutta4) {
    e.carried.resize(count);
    e.carriedMotion.resize(count);
    for (MotionState& stage : e.stage) stage = state;
    for (CornerArray& acceleration : e.stageAcceleration) acceleration.resize(count);
  }
}

Simulation::~Simulation() = default;
Simulation::Simulation(Simulation&&) noexcept = default;
Simulation& Simulation::operator=(Simulation&&) noexcept = default;

const CornerArray& carriedVelocities(const Simulation& simulation) {
  const bool multiStage = !simulation.engine->carried.component[0].empty();
  return multiStage ? simulation.engine->carried : simulation.state.velocity;
}

void kick(Simulation& simulation, std::size_t block, const Vec3& velocity) {
  for (std::size_t c = 0; c < kCorners; ++c) simulation.state.velocity.add(block, c, velocity);
  simulation.engine->clock[block].history_s = 0.0;
  simulation.engine->clock[block].explicitFrames = kExplicitFrames;
  simulation.restTime_s[block] = 0.0;
  wake(simulation, block);
}

struct Snapshot {
  MotionState state;
  Tether tether;
  double time_s;
  std::uint64_t frame;
  int substeps;
  std::vector<std::uint8_t> asleep;
  std::vector<double> restTime_s;
  Counters counters;
  StageTimes stageTimes;
  Engine engine;
};

std::shared_ptr<const Snapshot> takeSnapshot(const Simulation& s) {
  return std::make_shared<const Snapshot>(
      Snapshot{s.state, s.tether, s.time_s, s.frame, s.substeps, s.asleep, s.restTime_s, s.counters, s.stageTimes, *s.engine});
}

void restoreSnapshot(Simulation& s, const Snapshot& snapshot) {
  s.state = snapshot.state;
  s.tether = snapshot.tether;
  s.time_s = snapshot.time_s;
  s.frame = snapshot.frame;
  s.substeps = snapshot.substeps;
  s.asleep = snapshot.asleep;
  s.restTime_s = snapshot.restTime_s;
  s.counters = snapshot.counters;
  s.stageTimes = snapshot.stageTimes;
  *s.engine = snapshot.engine;
}

std::uint64_t stateHash(const Simulation& simulation) {
  Hash hash;
  const auto mixDoubles = [&](const auto& values) { hash.bytes(values.data(), values.size() * sizeof(double)); };
  for (const auto& values : simulation.state.position.component) mixDoubles(values);
  for (const auto& values : simulation.state.velocity.component) mixDoubles(values);
  hash.bytes(simulation.asleep.data(), simulation.asleep.size());
  for (const NearPair& pair : simulation.engine->pairs) {
    const Manifold& m = pair.manifold;
    hash.bytes(&m.count, sizeof m.count);
    mixDoubles(m.u);
    mixDoubles(m.v);
    mixDoubles(m.stretchX);
    mixDoubles(m.stretchY);
    mixDoubles(m.stretchZ);
    mixDoubles(m.relaxed);
    mixDoubles(m.offset);
  }
  for (const std::vector<ReportContact>& contacts : simulation.engine->report.contacts) {
    for (const ReportContact& contact : contacts) {
      hash.bytes(&contact.first, sizeof contact.first);
      hash.bytes(&contact.second, sizeof contact.second);
      hash.bytes(contact.corner.data(), contact.corner.size());
      mixDoubles(contact.weight);
      mixDoubles(contact.normal);
      hash.bytes(&contact.impulse, sizeof contact.impulse);
    }
  }
  return hash.value();
}

}  // namespace springtower
