#pragma once

#include "solver/statics/model.h"

#include <Eigen/Core>
#include <memory>
#include <span>
#include <vector>

namespace springtower {

/// The linear programme of rigid-block equilibrium with Coulomb friction: forces f >= 0 along the edges of the friction pyramids,
/// and loads of which a part may vary,
///   A f + w + sum_i s_i v_i = 0,  lower_i <= s_i <= upper_i,
/// solved by CLP's primal simplex. Edges of the pyramids are generated as columns when the prices of the last solution ask for
/// them (Dantzig & Wolfe 1960), so the programme stays small. Each solution starts from the one before, so related questions are
/// cheap. Not safe to use from two threads at once; different programmes are.
class EquilibriumProgram {
 public:
  /// `usable` are the indices of the model's points that may carry force; `load` is w. The model must outlive the programme.
  EquilibriumProgram(const StaticsModel& model, std::vector<std::size_t> usable, const Eigen::VectorXd& load);
  EquilibriumProgram(const EquilibriumProgram&) = delete;
  EquilibriumProgram& operator=(const EquilibriumProgram&) = delete;
  ~EquilibriumProgram();

  /// Adds a load that may vary, v, with s held at 0 so far; returns its index i.
  std::size_t addVariableLoad(const Eigen::VectorXd& direction);
  void setBounds(std::size_t variableLoad, double lower, double upper);

  /// Whether any forces balance the loads, to a part in ten million of a mean block weight. The questions below may be asked only
  /// after a yes, and bounds be only widened from there.
  bool isFeasible();

  /// The largest sum of costs_i s_i + sum_p pointCosts_p n_p, n the normal force of usable point p (one for each, or none at
  /// all). Infinite where nothing bounds it.
  double maximise(std::span<const double> costs, std::span<const double> pointCosts = {});

  /// The solution found last: s_i; force on the upper block in the point's frame for each usable point; and displacements of the
  /// blocks ([6 blocks], translation and rotation about the centre), the prices of the equilibrium's rows.
  [[nodiscard]] double variableLoad(std::size_t i) const;
  [[nodiscard]] std::vector<Vec3> forces() const;
  [[nodiscard]] Eigen::VectorXd prices() const;

 private:
  struct Solver;
  std::unique_ptr<Solver> solver_;
};

/// Whether forces that are all parallel to `gravity` balance it, at those of the points `usable` whose friction cone holds that
/// direction. A yes is a yes for the programme above; a no says nothing. One unknown for each point makes it some ten times
/// cheaper.
bool parallelForcesBalance(const StaticsModel& model, std::span<const std::size_t> usable, const Vec3& gravity);

}  // namespace springtower
