#include "apps/commands/run/forces_report.h"

#include "apps/common/json_values.h"
#include "solver/metrics/balance.h"

#include <cstddef>
#include <nlohmann/json.hpp>
#include <utility>

namespace springtower {
namespace {

using Json = nlohmann::ordered_json;

}  // namespace

Json forcesJson(const Simulation& simulation) {
  const Scene& scene = simulation.scene;
  const std::vector<ContactForce> activeSetNow = contactForces(simulation);
  const std::vector<Imbalance> left = imbalances(simulation, activeSetNow);
  Json blocks = Json::array();
  for (std::size_t b = 0; b < simulation.model.blockCount(); ++b) {
    const BlockSpec& spec = scene.blocks[b];
    blocks.push_back({{"block", b},
                      {"row", spec.row >= 0 ? Json(spec.row) : Json(nullptr)},
                      {"position", spec.position > 0 ? Json(spec.position) : Json(nullptr)},
                      {"mass_kg", simulation.model.mass[b]},
                      {"height_m", simulation.model.dimensions[b].minCoeff()},
                      {"centre_m", vectorJson(centre(simulation.state.position, b))},
                      {"asleep", simulation.asleep[b] != 0},
                      {"rest_s", simulation.restTime_s[b]},
                      {"force_imbalance", left[b].force},
                      {"torque_imbalance", left[b].torque}});
  }
  Json pushes = Json::array();
  for (const UserPush& user : userPushes(simulation))
    pushes.push_back({{"block", user.block},
                      {"place_m", vectorJson(user.place)},
                      {"force_n", vectorJson(user.force)},
                      {"torque_n_m", vectorJson(user.torque)}});
  Json contacts = Json::array();
  for (const ContactForce& contact : activeSetNow) {
    contacts.push_back({{"upper", blockJson(contact.upper)},
                        {"lower", blockJson(contact.lower)},
                        {"place_on_upper_m", vectorJson(contact.point)},
                        {"place_on_lower_m", vectorJson(contact.lowerPoint)},
                        {"normal", vectorJson(contact.normal)},
                        {"normal_n", contact.normalForce},
                        {"friction_n", vectorJson(contact.frictionForce)},
                        {"depth_mm", 1e3 * contact.depth},
                        {"sliding", contact.sliding}});
  }
  return {{"time_s", simulation.time_s},
          {"gravity_m_s2", vectorJson(scene.gravity.at(simulation.time_s))},
          {"static_friction", scene.staticFriction},
          {"kinetic_friction", scene.kineticFriction},
          {"blocks", std::move(blocks)},
          {"pushes", std::move(pushes)},
          {"contacts", std::move(contacts)}};
}

}  // namespace springtower
