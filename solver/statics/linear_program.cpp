#include "solver/statics/linear_program.h"

#include "core/elementary.h"
#include "core/tuning.h"
#include "solver/statics/lp_columns.h"

#include <ClpSimplex.hpp>
#include <algorithm>
#include <array>
#include <bitset>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

namespace springtower {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

double angleOf(int side) {
  return 2.0 * std::numbers::pi * side / tuning::kConeSides;
}

// Imbalance, positive and negative in each row.
void addSlacks(ClpSimplex& clp) {
  const int rows = clp.numberRows();
  LpColumns slacks;
  for (int row = 0; row < rows; ++row) {
    for (const double sign : {1.0, -1.0}) {
      slacks.add(row, sign);
      slacks.finish(1.0);
    }
  }
  slacks.addTo(clp);
}

void prepare(ClpSimplex& clp, int rows) {
  clp.setLogLevel(0);
  // The program is already scaled, with forces in block weights and lengths in block heights. CLP must not scale it, because
  // columns added later would not be scaled.
  clp.scaling(0);
  clp.setPrimalTolerance(tuning::kLpTolerance);
  clp.setDualTolerance(tuning::kLpTolerance);
  clp.resize(rows, 0);
}

}  // namespace

struct EquilibriumProgram::Solver {
  // A column of the program that is an edge of a point's pyramid.
  struct Edge {
    std::size_t point;  // index in `usable`
    int side;
  };

  const StaticsModel& model;
  std::vector<std::size_t> usable;
  std::vector<std::bitset<tuning::kConeSides>> present;  // of each usable point: edges that are columns
  std::vector<Edge> edges;                               // in the order of their columns, which start at firstEdge
  std::vector<int> loadColumns;
  std::vector<double> pointCosts;  // of the present objective, to be minimised
  std::vector<double> loadCosts;
  std::vector<int> edgeColumns;  // column of each edge
  int slackColumns = 0;
  bool seekingBalance = true;  // first phase: the cost is the imbalance alone
  ClpSimplex clp;

  Solver(const StaticsModel& theModel, std::vector<std::size_t> points)
      : model(theModel), usable(std::move(points)), present(usable.size()) {}

  // Unit force along an edge of a point's pyramid: normal component 1.
  [[nodiscard]] Vec3 edgeForce(const Edge& edge) const {
    const double friction = model.points[usable[edge.point]].friction;
    return {1.0, friction * elementary::cos(angleOf(edge.side)), friction * elementary::sin(angleOf(edge.side))};
  }

  void addEdges(const std::vector<Edge>& fresh) {
    LpColumns columns;
    for (const Edge& edge : fresh) {
      const ForcePoint& point = model.points[usable[edge.point]];
      for (const bool onUpper : {true, false}) {
        const std::int32_t block = onUpper ? point.upper : point.lower;
        if (block < 0) continue;
        const Vec6 wrench = model.wrench(point, onUpper) * edgeForce(edge);
        for (Eigen::Index i = 0; i < 6; ++i) {
          if (wrench[i] == 0.0) continue;
          columns.add(6 * block + static_cast<int>(i), wrench[i]);
        }
      }
      columns.finish(seekingBalance || pointCosts.empty() ? 0.0 : pointCosts[edge.point]);
      present[edge.point].set(static_cast<std::size_t>(edge.side));
      edgeColumns.push_back(clp.numberColumns() + columns.count() - 1);
      edges.push_back(edge);
    }
    columns.addTo(clp);
  }

  // The edges whose reduced cost would improve the solution: the best of each point.
  [[nodiscard]] std::vector<Edge> improvingEdges() const {
    std::vector<Edge> improving;
    const Eigen::Map<const Eigen::VectorXd> price(clp.dualRowSolution(), clp.numberRows());
    for (std::size_t p = 0; p < usable.size(); ++p) {
      const ForcePoint& point = model.points[usable[p]];
      Vec3 gain = model.wrench(point, true).transpose() * price.segment<6>(6 * point.upper);
      if (point.lower >= 0) gain += model.wrench(point, false).transpose() * price.segment<6>(6 * point.lower);
      if (!seekingBalance && !pointCosts.empty()) gain[0] -= pointCosts[p];
      // Without friction a pyramid is its axis, and one edge is enough.
      const double turns = point.friction > 0.0 ? elementary::atan2(gain[2], gain[1]) / (2.0 * std::numbers::pi) : 0.0;
      const int side = (static_cast<int>(std::lround(turns * tuning::kConeSides)) + tuning::kConeSides) % tuning::kConeSides;
      if (edgeForce({p, side}).dot(gain) <= tuning::kLpPriceTolerance || present[p].test(static_cast<std::size_t>(side)))
        continue;
      improving.push_back({p, side});
    }
    return improving;
  }

  // Solves for the present costs. Returns false if the cost is unbounded.
  bool solve(double goodEnough) {
    for (;;) {
      clp.primal();
      if (clp.status() == 2) return false;
      if (clp.status() != 0) {
        throw std::runtime_error("statics: the linear program could not be solved, status " + std::to_string(clp.status()));
      }
      if (clp.objectiveValue() <= goodEnough) return true;
      const std::vector<Edge> improving = improvingEdges();
      if (improving.empty()) return true;
      addEdges(improving);
    }
  }

  void setCosts() {
    for (std::size_t i = 0; i < loadColumns.size(); ++i) {
      clp.setObjectiveCoefficient(loadColumns[i], seekingBalance || i >= loadCosts.size() ? 0.0 : loadCosts[i]);
    }
    for (std::size_t e = 0; e < edges.size(); ++e) {
      clp.setObjectiveCoefficient(edgeColumns[e], seekingBalance || pointCosts.empty() ? 0.0 : pointCosts[edges[e].point]);
    }
    for (int i = 0; i < slackColumns; ++i) {
      clp.setObjectiveCoefficient(i, seekingBalance ? 1.0 : 0.0);
      // The small imbalance left by the first phase remains, so that the second starts from a feasible solution.
      clp.setColumnUpper(i, seekingBalance ? kInfinity : std::max(0.0, clp.primalColumnSolution()[i]));
    }
  }
};

EquilibriumProgram::EquilibriumProgram(const StaticsModel& model, std::vector<std::size_t> usable, const Eigen::VectorXd& load)
    : solver_(std::make_unique<Solver>(model, std::move(usable))) {
  ClpSimplex& clp = solver_->clp;
  const auto rows = static_cast<int>(load.size());
  prepare(clp, rows);
  for (int row = 0; row < rows; ++row) clp.setRowBounds(row, -load[row], -load[row]);
  addSlacks(clp);
  solver_->slackColumns = 2 * rows;
  std::vector<Solver::Edge> edges;
  for (std::size_t p = 0; p < solver_->usable.size(); ++p) {
    const int sides = model.points[solver_->usable[p]].friction > 0.0 ? tuning::kLpFirstSides : 1;
    for (int side = 0; side < tuning::kConeSides; side += tuning::kConeSides / sides) edges.push_back({p, side});
  }
  if (!edges.empty()) solver_->addEdges(edges);
}

EquilibriumProgram::~EquilibriumProgram() = default;

std::size_t EquilibriumProgram::addVariableLoad(const Eigen::VectorXd& direction) {
  std::vector<int> rows;
  std::vector<double> values;
  for (Eigen::Index i = 0; i < direction.size(); ++i) {
    if (direction[i] == 0.0) continue;
    rows.push_back(static_cast<int>(i));
    values.push_back(direction[i]);
  }
  solver_->loadColumns.push_back(solver_->clp.numberColumns());
  solver_->clp.addColumn(static_cast<int>(rows.size()), rows.data(), values.data(), 0.0, 0.0, 0.0);
  return solver_->loadColumns.size() - 1;
}

void EquilibriumProgram::setBounds(std::size_t variableLoad, double lower, double upper) {
  solver_->clp.setColumnBounds(solver_->loadColumns[variableLoad], lower, upper);
}

bool EquilibriumProgram::isFeasible() {
  solver_->seekingBalance = true;
  solver_->setCosts();
  solver_->solve(tuning::kMaxLpImbalance);
  return solver_->clp.objectiveValue() <= tuning::kMaxLpImbalance;
}

double EquilibriumProgram::maximise(std::span<const double> costs, std::span<const double> pointCosts) {
  Solver& solver = *solver_;
  solver.seekingBalance = false;
  // CLP minimises.
  solver.loadCosts.assign(costs.begin(), costs.end());
  solver.pointCosts.assign(pointCosts.begin(), pointCosts.end());
  for (double& cost : solver.loadCosts) cost = -cost;
  for (double& cost : solver.pointCosts) cost = -cost;
  solver.setCosts();
  return solver.solve(-kInfinity) ? -solver.clp.objectiveValue() : kInfinity;
}

double EquilibriumProgram::variableLoad(std::size_t i) const {
  return solver_->clp.primalColumnSolution()[solver_->loadColumns[i]];
}

std::vector<Vec3> EquilibriumProgram::forces() const {
  std::vector<Vec3> forces(solver_->usable.size(), Vec3::Zero());
  for (std::size_t e = 0; e < solver_->edges.size(); ++e) {
    const double size = solver_->clp.primalColumnSolution()[solver_->edgeColumns[e]];
    if (size > 0.0) forces[solver_->edges[e].point] += size * solver_->edgeForce(solver_->edges[e]);
  }
  return forces;
}

Eigen::VectorXd EquilibriumProgram::prices() const {
  return Eigen::Map<const Eigen::VectorXd>(solver_->clp.dualRowSolution(), solver_->clp.numberRows());
}

bool parallelForcesBalance(const StaticsModel& model, std::span<const std::size_t> usable, const Vec3& gravity) {
  const Vec3 up = -gravity.normalized();
  const Vec3 hint = std::abs(up.x()) < 0.9 ? Vec3::UnitX() : Vec3::UnitY();
  const Vec3 across = (hint - up * up.dot(hint)).normalized();
  const Eigen::Matrix3d axes = (Eigen::Matrix3d() << up, across, up.cross(across)).finished();
  ClpSimplex clp;
  const auto blocks = static_cast<int>(model.blockCount());
  prepare(clp, 3 * blocks);
  for (int b = 0; b < blocks; ++b) {
    const double weight = model.weight[static_cast<std::size_t>(b)] * gravity.norm();
    clp.setRowBounds(3 * b, weight, weight);
    for (const int row : {3 * b + 1, 3 * b + 2}) clp.setRowBounds(row, 0.0, 0.0);
  }
  addSlacks(clp);
  LpColumns columns;
  for (const std::size_t p : usable) {
    const ForcePoint& point = model.points[p];
    const double leastCosine = 1.0 / std::sqrt(1.0 + point.friction * point.friction);
    // With the rounding of a slope that equals the friction.
    if (point.frame.col(0).dot(up) < leastCosine * (1.0 - 1e-12)) continue;
    for (const bool onUpper : {true, false}) {
      const std::int32_t block = onUpper ? point.upper : point.lower;
      if (block < 0) continue;
      const Vec6 wrench = model.wrench(point, onUpper) * (point.frame.transpose() * up);
      // Force along gravity, and the torques perpendicular to it; the others vanish.
      const Vec3 entries(wrench.head<3>().dot(up), wrench.tail<3>().dot(axes.col(1)), wrench.tail<3>().dot(axes.col(2)));
      for (int i = 0; i < 3; ++i) columns.add(3 * block + i, entries[i]);
    }
    columns.finish(0.0);
  }
  columns.addTo(clp);
  clp.primal();
  return clp.status() == 0 && clp.objectiveValue() <= tuning::kMaxLpImbalance;
}

}  // namespace springtower
