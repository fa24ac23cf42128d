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

std::uint64_t stateHash(const Simulation& simulation) {
  Hash hash;
  const auto mixDoubles = [&](const auto& values) {
    hash.bytes(values.data(), static_cast<std::size_t>(values.size()) * sizeof(double));
  };
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
