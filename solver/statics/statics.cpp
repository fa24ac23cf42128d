#include "solver/statics/statics.h"

#include "core/error.h"
#include "core/parallel.h"
#include "core/scene/remove_block.h"
#include "core/tuning.h"
#include "solver/statics/forces.h"
#include "solver/statics/loose.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

namespace springtower {
namespace {

std::vector<std::size_t> allPoints(const StaticsModel& model) {
  std::vector<std::size_t> points(model.points.size());
  for (std::size_t p = 0; p < points.size(); ++p) points[p] = p;
  return points;
}

std::vector<std::size_t> closedPoints(const StaticsModel& model, const std::vector<double>& gap_m) {
  std::vector<std::size_t> points;
  for (std::size_t p = 0; p < model.points.size(); ++p) {
    if (gap_m[p] <= tuning::kClosedGap * model.lengthUnit_m) points.push_back(p);
  }
  return points;
}

bool isBorne(const StaticsModel& model, const std::vector<std::size_t>& points, const Vec3& gravity) {
  // The cheaper test first.
  if (parallelForcesBalance(model, points, gravity)) return true;
  return EquilibriumProgram(model, points, model.gravityLoad(gravity)).isFeasible();
}

struct Settlement {
  std::vector<double> gap_m;  // of each point after settlement
  double motion_m = 0.0;
};

// Settlement of the blocks under gravity straight down, without friction.
std::optional<Settlement> settle(const StaticsModel& model) {
  StaticsModel smooth = model;
  smooth.friction = 0.0;
  for (ForcePoint& point : smooth.points) point.friction = 0.0;
  EquilibriumProgram program(smooth, allPoints(smooth), smooth.gravityLoad(-Vec3::UnitZ()));
  if (!program.isFeasible()) return {};
  std::vector<double> costs;
  for (const ForcePoint& point : smooth.points) costs.push_back(-point.gap_m / smooth.lengthUnit_m);
  program.maximise({}, costs);
  // The dual values are the motion, reversed: in mean heights, and radians.
  const Eigen::VectorXd price = program.prices();
  Settlement settlement;
  for (std::size_t b = 0; b < model.blockCount(); ++b) {
    const Vec6 motion = price.segment<6>(static_cast<Eigen::Index>(6 * b));
    if (motion.tail<3>().norm() > tuning::kMaxStaticTurn || motion[2] > tuning::kMaxStaticSinking) return {};
    settlement.motion_m = std::max(settlement.motion_m, motion.head<3>().norm() * model.lengthUnit_m);
  }
  for (const ForcePoint& point : model.points) {
    double closing = (model.wrench(point, true).transpose() * price.segment<6>(6 * point.upper))[0];
    if (point.lower >= 0) closing += (model.wrench(point, false).transpose() * price.segment<6>(6 * point.lower))[0];
    settlement.gap_m.push_back(std::max(0.0, point.gap_m - closing * model.lengthUnit_m));
  }
  return settlement;
}

bool hasGaps(const StaticsModel& model) {
  return std::any_of(model.points.begin(), model.points.end(), [](const ForcePoint& point) { return point.gap_m > 0.0; });
}

Scene without(const Scene& scene, BlockId block) {
  Scene rest = scene;
  rest.forces.clear();
  rest.drives.clear();
  removeBlock(rest, index(block));
  return rest;
}

}  // namespace

StaticScene staticScene(const Scene& scene) {
  StaticScene result;
  double least = std::numeric_limits<double>::infinity();
  for (const BlockSpec& block : scene.blocks) least = std::min(least, block.dimensions.minCoeff());
  result.facings = facingBlocks(scene, tuning::kStaticReach * least);
  result.model = staticsModel(scene, result.facings);
  result.gravity = scene.gravity.at(0.0) / scene.gravity.magnitude;
  const StaticsModel& model = result.model;
  for (const ForcePoint& point : model.points) result.settledGap_m.push_back(point.gap_m);
  result.usable = closedPoints(model, result.settledGap_m);
  if (isBorne(model, result.usable, result.gravity)) {
    result.rest = Rest::stands;
    return result;
  }
  if (!hasGaps(model)) return result;
  if (auto settlement = settle(model)) {
    const std::vector<std::size_t> closed = closedPoints(model, settlement->gap_m);
    if (isBorne(model, closed, result.gravity)) {
      result.rest = Rest::leans;
      result.usable = closed;
      result.settledGap_m = std::move(settlement->gap_m);
      result.settlement_m = settlement->motion_m;
      return result;
    }
  }
  result.usable = allPoints(model);
  return result;
}

std::optional<StabilityMargin> tiltMargin(const StaticScene& scene, double tolerance_deg) {
  return tiltMargin(scene.model, scene.usable, scene.gravity, tolerance_deg);
}

std::optional<double> tiltTowards(const StaticScene& scene, double direction_deg) {
  return tiltTowards(scene.model, scene.usable, direction_deg);
}

ContactLoads contactLoads(const StaticScene& scene) {
  const StaticsModel& model = scene.model;
  const Eigen::VectorXd load = model.gravityLoad(scene.gravity);
  ContactLoads loads;
  std::optional<std::vector<Vec3>> forces = leastSquaresForces(model, scene.usable, load);
  if (!forces) {
    EquilibriumProgram program(model, scene.usable, load);
    program.isFeasible();
    forces = program.forces();
    loads.anyOfMany = true;
  }
  for (const FacePair& facing : scene.facings) {
    ContactLoad& contact = loads.contacts.emplace_back();
    contact.upper = facing.upper;
    contact.lower = facing.lower;
    for (const FacingPoint& point : facing.points) contact.place += point.place / static_cast<double>(facing.points.size());
  }
  std::vector<Vec3> pointForces(model.points.size(), Vec3::Zero());
  std::vector<Vec3> pressure(scene.facings.size(), Vec3::Zero());
  for (std::size_t i = 0; i < scene.usable.size(); ++i) {
    const ForcePoint& point = model.points[scene.usable[i]];
    ContactLoad& contact = loads.contacts[point.facing];
    const Vec3 force = (*forces)[i] * model.forceUnit_n;
    pointForces[scene.usable[i]] = point.frame * force;
    contact.force += point.frame * force;
    contact.normal_n += force[0];
    pressure[point.facing] += force[0] * point.place;
    const double bound = point.friction * force[0];
    // For a negligible force the ratio is meaningless.
    if (force[0] > tuning::kMinStaticLoad * model.forceUnit_n && bound > 0.0) {
      contact.frictionUsed = std::max(contact.frictionUsed, std::min(1.0, force.tail<2>().norm() / bound));
    }
  }
  for (std::size_t p = 0; p < model.points.size(); ++p)
    loads.contacts[model.points[p].facing].pointForces.push_back(pointForces[p]);
  for (std::size_t c = 0; c < loads.contacts.size(); ++c) {
    ContactLoad& contact = loads.contacts[c];
    if (contact.normal_n > tuning::kMinStaticLoad * model.forceUnit_n) contact.place = pressure[c] / contact.normal_n;
  }
  return loads;
}

std::vector<BlockLoad> blockLoads(const StaticScene& scene, const ContactLoads& loads) {
  const StaticsModel& model = scene.model;
  const std::size_t blocks = model.blockCount();
  std::vector<BlockLoad> result(blocks);
  std::vector<char> touched(blocks, 0);
  for (std::size_t b = 0; b < blocks; ++b) {
    result[b].weight_n = model.weight[b] * model.forceUnit_n;
    result[b].gap_m = std::numeric_limits<double>::infinity();
  }
  // A block beside another does not lie on it.
  const auto liesBelow = [](const ForcePoint& point) { return point.lower >= 0 && point.frame(2, 0) > 0.5; };
  for (const std::size_t p : scene.usable) {
    if (liesBelow(model.points[p])) touched[static_cast<std::size_t>(model.points[p].lower)] = 1;
  }
  for (std::size_t p = 0; p < model.points.size(); ++p) {
    if (!liesBelow(model.points[p])) continue;
    BlockLoad& load = result[static_cast<std::size_t>(model.points[p].lower)];
    load.covered = true;
    load.gap_m = std::min(load.gap_m, scene.settledGap_m[p]);
  }
  for (std::size_t c = 0; c < scene.facings.size(); ++c) {
    const FacePair& facing = scene.facings[c];
    if (facing.lower != kFloor && facing.normal.z() > 0.5) result[index(facing.lower)].above_n += loads.contacts[c].normal_n;
  }
  EquilibriumProgram program(model, scene.usable, model.gravityLoad(scene.gravity));
  program.isFeasible();
  std::vector<double> costs(scene.usable.size());
  for (std::size_t b = 0; b < blocks; ++b) {
    BlockLoad& load = result[b];
    if (touched[b] != 0) {
      for (const double sign : {-1.0, 1.0}) {
        for (std::size_t i = 0; i < costs.size(); ++i) {
          const ForcePoint& point = model.points[scene.usable[i]];
          costs[i] = liesBelow(point) && point.lower == static_cast<std::int32_t>(b) ? sign : 0.0;
        }
        const double extreme = program.maximise({}, costs) * model.forceUnit_n;
        if (sign < 0.0) {
          load.leastAbove_n = std::max(0.0, -extreme);
        } else if (std::isfinite(extreme)) {
          load.greatestAbove_n = extreme;
        }
      }
    } else {
      load.greatestAbove_n = 0.0;
    }
    constexpr double kUnbounded = std::numeric_limits<double>::infinity();
    load.loose = isLoose(load.covered, load.greatestAbove_n.value_or(kUnbounded), model.forceUnit_n);
    if (!load.covered) load.gap_m = 0.0;
  }
  return result;
}

Removal removalOf(const Scene& scene, BlockId block, double tolerance_deg) {
  const Scene rest = without(scene, block);
  // Without blocks that could, nothing falls.
  if (std::all_of(rest.blocks.begin(), rest.blocks.end(), [](const BlockSpec& other) { return other.fixed; }))
    return {Rest::stands, {}};
  const StaticScene statics = staticScene(rest);
  return {statics.rest, tiltMargin(statics, tolerance_deg)};
}

std::vector<Removal> removals(const Scene& scene, double tolerance_deg) {
  std::vector<Removal> result(scene.blocks.size());
  forEach(result.size(), [&](std::size_t b) { result[b] = removalOf(scene, blockId(b), tolerance_deg); });
  return result;
}

std::optional<double> pullLimit(const StaticScene& scene, BlockId block, const Vec3& direction) {
  const StaticsModel& model = scene.model;
  if (scene.rest == Rest::falls) return {};
  if (model.weight[index(block)] == 0.0) return std::numeric_limits<double>::infinity();  // fixed
  EquilibriumProgram program(model, scene.usable, model.gravityLoad(scene.gravity));
  Eigen::VectorXd pull = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(6 * model.blockCount()));
  pull.segment<3>(static_cast<Eigen::Index>(6 * index(block))) = direction;
  program.addVariableLoad(pull);
  if (!program.isFeasible()) return {};
  program.setBounds(0, 0.0, tuning::kMaxStaticPull);
  const double limit = program.maximise(std::array{1.0});
  return limit < 0.999 * tuning::kMaxStaticPull ? limit * model.forceUnit_n : std::numeric_limits<double>::infinity();
}

}  // namespace springtower
