#include "apps/commands/run/forces_report.h"
#include "apps/commands/validate/frames.h"
#include "apps/commands/validate/validate.h"
#include "apps/common/interruption.h"
#include "solver/runner/run.h"
#include "solver/runner/trials.h"
#include "solver/statics/statics.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>

namespace springtower {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kForceTolerance = 1e-3;  // of a block's weight, and of its weight times its height
constexpr double kConeTolerance_n = 1e-9;
constexpr double kSlipTolerance = 0.01;

Vec3 vectorOf(const Json& json) {
  return {json.at(0).get<double>(), json.at(1).get<double>(), json.at(2).get<double>()};
}

// The worst block and contact of a file of forces.
struct Balance {
  double force = 0.0;   // left over, in weights of its block
  double torque = 0.0;  // in its weight times its height
  double outside_n = -1e300;
  std::size_t contacts = 0;
  std::size_t resting = 0;
};

// Adds up what was written; nothing but the file is used.
Balance balanceOf(const Json& forces) {
  const Vec3 gravity = vectorOf(forces.at("gravity_m_s2"));
  const Json& blocks = forces.at("blocks");
  std::vector<Vec3> force(blocks.size());
  std::vector<Vec3> torque(blocks.size(), Vec3::Zero());
  for (std::size_t b = 0; b < blocks.size(); ++b) force[b] = blocks.at(b).at("mass_kg").get<double>() * gravity;
  const auto push = [&](const Json& block, const Vec3& by, const Vec3& place) {
    if (block.is_string()) return;  // the floor
    const auto b = block.get<std::size_t>();
    force[b] += by;
    torque[b] += (place - vectorOf(blocks.at(b).at("centre_m"))).cross(by);
  };
  for (const Json& user : forces.at("pushes")) push(user.at("block"), vectorOf(user.at("force_n")), vectorOf(user.at("place_m")));
  Balance worst;
  const double friction = std::max(forces.at("static_friction").get<double>(), forces.at("kinetic_friction").get<double>());
  for (const Json& contact : forces.at("contacts")) {
    const double normal = contact.at("normal_n").get<double>();
    const Vec3 tangential = vectorOf(contact.at("friction_n"));
    const Vec3 all = normal * vectorOf(contact.at("normal")) + tangential;
    push(contact.at("upper"), all, vectorOf(contact.at("place_on_upper_m")));
    push(contact.at("lower"), -all, vectorOf(contact.at("place_on_lower_m")));
    worst.outside_n = std::max(worst.outside_n, tangential.norm() - friction * normal);
    ++worst.contacts;
  }
  for (std::size_t b = 0; b < blocks.size(); ++b) {
    if (!(blocks.at(b).at("rest_s").get<double>() > 0.0)) continue;
    ++worst.resting;
    const double weight = blocks.at(b).at("mass_kg").get<double>() * gravity.norm();
    worst.force = std::max(worst.force, force[b].norm() / weight);
    worst.torque = std::max(worst.torque, torque[b].norm() / (weight * blocks.at(b).at("height_m").get<double>()));
  }
  return worst;
}

struct RestingScene {
  std::string name;
  Scene scene;
  double seconds;
};

std::vector<RestingScene> restingScenes(bool longForm) {
  std::vector<RestingScene> scenes;
  Scene awake = towerScene(18);
  awake.settings.sleep = Sleep::off;
  scenes.push_back({"18 rows, sleep off", awake, 5.0});
  scenes.push_back({"18 rows asleep", towerScene(18), 5.0});
  Scene leaning = bitCodeScene("(1L1)-(010)-(111)-(101)");
  leaning.gravity.tilt_deg = 8.0;
  leaning.gravity.direction_deg = 30.0;
  scenes.push_back({"(1L1)-(010)-(111)-(101), gravity turned by 8 degrees", leaning, 6.0});
  for (std::uint64_t seed = 1; seed <= (longForm ? 10U : 1U); ++seed) {
    TowerOptions uneven;
    uneven.heightsSigma_m = 0.0002;
    uneven.massSigma_kg = 0.00185;
    uneven.seed = seed;
    scenes.push_back({fmt::format("18 uneven rows, seed {}", seed), towerScene(18, uneven), 12.0});
  }
  return scenes;
}

// What is pulled, and how.
struct PulledBlock {
  std::string name;
  Scene scene;
  std::size_t block;
  Vec3 towards;
  double settle_s;
  bool alone;
};

std::size_t blockAt(const Scene& scene, int row, int position) {
  const auto found = std::find_if(scene.blocks.begin(), scene.blocks.end(),
                                  [&](const BlockSpec& block) { return block.row == row && block.position == position; });
  return static_cast<std::size_t>(found - scene.blocks.begin());
}

// Every block along its length, and outer ones of a tower sideways as well, as they come out by the shorter way.
std::vector<PulledBlock> pulledBlocks(bool longForm) {
  std::vector<PulledBlock> pulled;
  const auto add = [&](const std::string& name, Scene scene, int row, int position, double settle_s, bool sideways = false) {
    scene.settings.sleep = Sleep::off;
    const std::size_t block = blockAt(scene, row, position);
    const bool alone = scene.blocks.size() == 1;
    const Vec3 outwards = (position - 2) * (row % 2 == 0 ? Vec3::UnitY() : Vec3::UnitX());
    const Vec3 towards = sideways ? outwards : scene.blocks[block].orientation * Vec3::UnitX();
    pulled.push_back({name, std::move(scene), block, towards, settle_s, alone});
  };
  add("alone on the floor", bitCodeScene("(010)"), 0, 2, 0.5);
  const Scene tower = towerScene(18);
  add("18 rows, row 2, middle", tower, 1, 2, 3.0);
  add("18 rows, row 9, middle", tower, 8, 2, 3.0);
  add("18 rows, row 16, middle", tower, 15, 2, 3.0);
  add("18 rows, row 9, side", tower, 8, 1, 3.0);
  add("18 rows, row 9, side, sideways", tower, 8, 1, 3.0, true);
  add("loose, lying between rows", bitCodeScene("(111)-(111)-(1L1)-(111)-(111)"), 2, 2, 2.0);
  if (!longForm) return pulled;
  for (int row = 0; row < 18; ++row) {
    for (int position = 1; position <= 3; ++position) {
      const std::string name = fmt::format("18 rows, row {}, position {}", row + 1, position);
      add(name, tower, row, position, 3.0);
      if (position != 2) add(name + ", sideways", tower, row, position, 3.0, true);
    }
  }
  return pulled;
}

}  // namespace

ValidationSection validateForces(const ValidationPlan& plan) {
  ValidationSection section{
      "Forces",
      "The forces that `run --report --forces` writes, added up from the written text: what is left over on "
      "every block at rest, gravity included, and how far the worst contact is outside its cone of friction."};
  const std::vector<RestingScene> scenes = restingScenes(plan.longForm);
  std::vector<Balance> balances(scenes.size());
  tbb::parallel_for(std::size_t{0}, scenes.size(), [&](std::size_t i) {
    tbb::this_task_arena::isolate([&] {
      Simulation simulation(scenes[i].scene);
      while (simulation.time_s < scenes[i].seconds) stepFrameOrEnd(simulation);
      balances[i] = balanceOf(Json::parse(forcesJson(simulation).dump()));
    });
  });
  for (std::size_t i = 0; i < scenes.size(); ++i) {
    const Balance& balance = balances[i];
    const std::size_t blocks = scenes[i].scene.blocks.size();
    section.claims.push_back({scenes[i].name + ": blocks at rest", fmt::format("all {}", blocks),
                              fmt::format("{}", balance.resting), balance.resting == blocks});
    section.claims.push_back({scenes[i].name + ": force left over", "0.1 % of the block's weight",
                              fmt::format("{:.2g} %", 100.0 * balance.force), balance.force <= kForceTolerance});
    section.claims.push_back({scenes[i].name + ": torque left over", "0.1 % of weight times height",
                              fmt::format("{:.2g} %", 100.0 * balance.torque), balance.torque <= kForceTolerance});
    section.claims.push_back({scenes[i].name + ": outside the cone", "1e-9 N",
                              fmt::format("{:.2g} N, {} contact points", std::max(0.0, balance.outside_n), balance.contacts),
                              balance.outside_n <= kConeTolerance_n});
  }
  return section;
}

ValidationSection validatePulls(const ValidationPlan& plan) {
  ValidationSection section{
      "Pulling",
      "A block is pulled at its centre along its length, an outer one sideways as well, by a force that grows by 1 % of the "
      "friction limit a second. At first slip (0.05 mm against all that it touches) the force is friction times the sum of the "
      "normal forces on it just before, and no more than statics allows. Friction times the normal forces is an upper bound: "
      "where light blocks turn with the one that is pulled less will do, and limit analysis at these normal forces says how "
      "much. Rows count from 1 at the bottom."};
  const std::vector<PulledBlock> pulled = pulledBlocks(plan.longForm);
  std::vector<SlipTrial> trials(pulled.size());
  std::vector<double> limits_n(pulled.size(), 0.0);
  tbb::parallel_for(std::size_t{0}, pulled.size(), [&](std::size_t i) {
    tbb::this_task_arena::isolate([&] {
      Simulation simulation(pulled[i].scene);
      while (simulation.time_s < pulled[i].settle_s) stepFrameOrEnd(simulation);
      trials[i] = pullUntilSlip(simulation, pulled[i].block, pulled[i].towards, endIfInterrupted);
      limits_n[i] = pullLimit(staticScene(pulled[i].scene), blockId(pulled[i].block), pulled[i].towards).value_or(0.0);
    });
  });
  PlotLine friction{"force at first slip over friction", {}};
  friction.joined = false;
  for (std::size_t i = 0; i < pulled.size(); ++i) {
    const SlipTrial& trial = trials[i];
    const double bears_n =
        pulled[i].scene.staticFriction *
        (pulled[i].alone ? pulled[i].scene.blocks[0].mass * pulled[i].scene.gravity.magnitude : trial.normal_n);
    const double ratio = bears_n > 0.0 ? trial.force_n / bears_n : 0.0;
    section.claims.push_back(
        {pulled[i].name + (pulled[i].alone ? ": force over mu m g" : ": force over mu times normal forces"), "1 within 1 %",
         trial.slipped ? fmt::format("{:.4f} ({:.4f} N; friction limit {:.4f})", ratio, trial.force_n, trial.limit_n / bears_n)
                       : fmt::format("no slip at {:.3f} N", trial.force_n),
         trial.slipped && std::abs(ratio - 1.0) <= kSlipTolerance});
    section.claims.push_back({pulled[i].name + ": force over the friction limit at these normal forces", "1 within 1 %",
                              fmt::format("{:.4f}", trial.force_n / trial.limit_n),
                              trial.slipped && std::abs(trial.force_n / trial.limit_n - 1.0) <= kSlipTolerance});
    section.claims.push_back({pulled[i].name + ": force over what statics allows", "at most 1 (and 1 % of measuring)",
                              fmt::format("{:.4f}", trial.force_n / limits_n[i]),
                              trial.slipped && trial.force_n <= (1.0 + kSlipTolerance) * limits_n[i]});
    friction.points.push_back({static_cast<double>(i + 1), ratio});
  }
  Plot plot;
  plot.title = "Force at first slip";
  plot.subtitle = "over friction times the normal forces just before, in the order of the table";
  plot.x.title = "block of the table";
  plot.y.title = "ratio";
  plot.y.least = 0.9;
  plot.y.most = 1.1;
  plot.lines = {friction};
  plot.references = {{1.0, "Coulomb"}};
  section.figures.push_back({"pull", plot});
  return section;
}

}  // namespace springtower
