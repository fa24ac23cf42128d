#include "solver/world/simulation.h"

#include "core/hash.h"
#include "solver/world/engine.h"

namespace springtower {

Simulation::~Simulation() = default;
Simulation::Simulation(Simulation&&) noexcept = default;
Simulation& Simulation::operator=(Simulation&&) noexcept = default;

const ParticleArray& carriedVelocities(const Simulation& simulation) {
  const bool multiStage = !simulation.engine->memo.carried.component[0].empty();
  return multiStage ? simulation.engine->memo.carried : simulation.state.velocity;
}

struct Snapshot {
  // Inputs.
  Gravity gravity;
  std::vector<UserForce> forces;
  double staticFriction;
  double kineticFriction;
  Sleep sleep;
  Tether tether;
  // State.
  MotionState state;
  double time_s;
  std::uint64_t frame;
  std::vector<std::uint8_t> asleep;
  std::vector<double> restTime_s;
  PairTable pairs;
  ContactPool contacts;
  SleepState sleepState;
  ReportState report;
  // Whatever else the next frame depends on, and the counters.
  Memo memo;
  int substeps;
  Counters counters;
  StageTimes stageTimes;
  WakeCounts wakes;
};

std::shared_ptr<const Snapshot> takeSnapshot(const Simulation& s) {
  const Engine& e = *s.engine;
  return std::make_shared<const Snapshot>(Snapshot{s.scene.gravity,
                                                   s.scene.forces,
                                                   s.scene.staticFriction,
                                                   s.scene.kineticFriction,
                                                   s.scene.settings.sleep,
                                                   s.tether,
                                                   s.state,
                                                   s.time_s,
                                                   s.frame,
                                                   s.asleep,
                                                   s.restTime_s,
                                                   e.pairs,
                                                   e.contacts,
                                                   e.sleep,
                                                   e.report,
                                                   e.memo,
                                                   s.substeps,
                                                   s.counters,
                                                   s.stageTimes,
                                                   s.wakes});
}

void restoreSnapshot(Simulation& s, const Snapshot& snapshot) {
  s.scene.gravity = snapshot.gravity;
  s.scene.forces = snapshot.forces;
  s.scene.staticFriction = snapshot.staticFriction;
  s.scene.kineticFriction = snapshot.kineticFriction;
  s.friction = FrictionTable(s.scene);
  s.scene.settings.sleep = snapshot.sleep;
  s.tether = snapshot.tether;
  s.state = snapshot.state;
  s.time_s = snapshot.time_s;
  s.frame = snapshot.frame;
  s.asleep = snapshot.asleep;
  s.restTime_s = snapshot.restTime_s;
  Engine& e = *s.engine;
  e.pairs = snapshot.pairs;
  e.contacts = snapshot.contacts;
  e.sleep = snapshot.sleepState;
  e.report = snapshot.report;
  e.memo = snapshot.memo;
  s.substeps = snapshot.substeps;
  s.counters = snapshot.counters;
  s.stageTimes = snapshot.stageTimes;
  s.wakes = snapshot.wakes;
}

std::uint64_t stateHash(const Simulation& simulation) {
  Hash hash;
  const auto mixDoubles = [&](const auto& values) { hash.bytes(values.data(), values.size() * sizeof(double)); };
  for (const auto& values : simulation.state.position.component) mixDoubles(values);
  for (const auto& values : simulation.state.velocity.component) mixDoubles(values);
  hash.bytes(simulation.asleep.data(), simulation.asleep.size());
  // Eight points a pair whether it touches or not, one quantity of all points after the other.
  const auto mixContact = [&](const ContactView& contact) {
    static const PlaceRow kNowhere{};
    static const PointRow kNothing{};
    const std::size_t rows = rowsFor(contact.count);
    const auto place = [&](std::size_t row) -> const PlaceRow& { return row < rows ? *contact.place[row] : kNowhere; };
    const auto points = [&](std::size_t row) -> const PenaltyRow& {
      return row < rows ? contact.points[row]->penalty : kNothing.penalty;
    };
    hash.bytes(&contact.count, sizeof contact.count);
    for (std::size_t r = 0; r < kManifoldRows; ++r) mixDoubles(place(r).u);
    for (std::size_t r = 0; r < kManifoldRows; ++r) mixDoubles(place(r).v);
    for (std::size_t a = 0; a < 3; ++a) {
      for (std::size_t r = 0; r < kManifoldRows; ++r) mixDoubles(points(r).displacement[a]);
    }
    for (std::size_t r = 0; r < kManifoldRows; ++r) mixDoubles(points(r).maxwellDepth);
    for (std::size_t r = 0; r < kManifoldRows; ++r) mixDoubles(points(r).restDepth);
  };
  for (std::size_t at = 0; at < simulation.engine->pairs.size(); ++at) mixContact(contactOf(*simulation.engine, at));
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
