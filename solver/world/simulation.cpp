#include "solver/world/simulation.h"

#include "core/hash.h"
#include "solver/world/engine.h"

namespace springtower {

Simulation::~Simulation() = default;
Simulation::Simulation(Simulation&&) noexcept = default;
Simulation& Simulation::operator=(Simulation&&) noexcept = default;

const ParticleArray& carriedVelocities(const Simulation& simulation) {
  const bool multiStage = !simulation.engine->carried.component[0].empty();
  return multiStage ? simulation.engine->carried : simulation.state.velocity;
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
  WakeCounts wakes;
  Engine engine;
};

std::shared_ptr<const Snapshot> takeSnapshot(const Simulation& s) {
  return std::make_shared<const Snapshot>(Snapshot{s.state, s.tether, s.time_s, s.frame, s.substeps, s.asleep, s.restTime_s,
                                                   s.counters, s.stageTimes, s.wakes, *s.engine});
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
  s.wakes = snapshot.wakes;
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
