#include "solver/statics/friction_limit.h"

#include "core/elementary.h"
#include "core/state.h"
#include "core/tuning.h"
#include "solver/statics/lp_columns.h"

#include <ClpSimplex.hpp>
#include <array>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>
#include <vector>

namespace springtower {
namespace {

constexpr int kRows = 3;  // of a block: two forces and a torque

}  // namespace

double frictionLimit_n(const Simulation& simulation, std::span<const ContactForce> contacts, BlockId block,
                       const Vec3& direction) {
  // In weights and heights of a block, so that towers of any size give the same program.
  const double length_m = simulation.lengths.blockHeight_m;
  const double force_n = simulation.model.mass[index(block)] * simulation.scene.gravity.magnitude;
  const int balances = kRows * static_cast<int>(simulation.model.blockCount());

  // A friction force is a convex combination of the corners of its polygon: shares that sum to at most 1, a row for each contact.
  LpColumns columns;
  int rows = balances;
  for (const ContactForce& contact : contacts) {
    if (!(contact.normalForce > 0.0)) continue;
    const double most = staticFrictionOf(simulation, contact) * contact.normalForce / force_n;
    for (int side = 0; side < tuning::kFrictionLimitSides; ++side) {
      const double angle = 2.0 * std::numbers::pi * side / tuning::kFrictionLimitSides;
      const std::array<double, 2> friction = {most * elementary::cos(angle), most * elementary::sin(angle)};
      const auto push = [&](BlockId on, double sign, const Vec3& place) {
        if (on == kFloor || simulation.model.isFixed(index(on))) return;
        const int first = kRows * static_cast<int>(index(on));
        const Vec3 arm = (place - centre(simulation.state.position, index(on))) / length_m;
        columns.add(first, sign * friction[0]);
        columns.add(first + 1, sign * friction[1]);
        columns.add(first + 2, sign * (arm.x() * friction[1] - arm.y() * friction[0]));
      };
      push(contact.upper, 1.0, contact.point);
      push(contact.lower, -1.0, contact.lowerPoint);
      columns.add(rows, 1.0);
      columns.finish(0.0);
    }
    ++rows;
  }
  columns.add(kRows * static_cast<int>(index(block)), direction.x());
  columns.add(kRows * static_cast<int>(index(block)) + 1, direction.y());
  columns.finish(-1.0);  // CLP minimises

  ClpSimplex clp;
  clp.setLogLevel(0);
  clp.scaling(0);  // scaled already
  clp.resize(rows, 0);
  for (int row = 0; row < balances; ++row) clp.setRowBounds(row, 0.0, 0.0);
  for (int row = balances; row < rows; ++row) clp.setRowBounds(row, -COIN_DBL_MAX, 1.0);
  columns.addTo(clp);
  clp.primal();
  if (clp.status() != 0) {
    throw std::runtime_error("friction limit: the linear program could not be solved, status " + std::to_string(clp.status()));
  }
  return -clp.objectiveValue() * force_n;
}

}  // namespace springtower
