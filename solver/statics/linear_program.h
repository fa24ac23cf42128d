#pragma once

#include "solver/statics/model.h"

#include <Eigen/Core>
#include <memory>
#include <span>
#include <vector>

namespace springtower {

/// The linear program of rigid-block equilibrium with Coulomb friction: forces f >= 0 along the edges of the friction pyramids,
/// and loads of which a part may vary,
///   A f + w + sum_i s_i v_i = 0,  lower_i <= s_i <= upper_i,
/// solved by CLP's primal simplex. Edges of the pyramids are generated as columns when their reduced costs in the last solution
/// require it (Dantzig & Wolfe 1960), so the program stays small. Each solution starts from the one before, so a sequence of
/// related solutions is cheap. An object must not be used from two threads at once; different objects may be.
class EquilibriumProgram {
 public:
  /// `usable` are the indices of the model's points that may carry force; `load` is w. The model must outlive the object.
  EquilibriumProgram(const StaticsModel& model, std::vector<std::size_t> usable, const Eigen::VectorXd& load);
  EquilibriumProgram(const EquilibriumProgram&) = delete;
  EquilibriumProgram& operator=(const EquilibriumProgram&) = delete;
  ~EquilibriumProgram();

  /// Adds a variable load v, with s fixed at 0 at first; returns its index i.
  std::size_t addVariableLoad(const Eigen::VectorXd& direction);
  void setBounds(std::size_t variableLoad, double lower, double upper);

  /// Whether any forces balance the loads, to 1e-7 of a mean block weight. The functions below may be called only after it has
  /// returned true, and from then on bounds may only be widened.
  bool isFeasible();

  /// The largest value of sum of costs_i s_i + sum_p pointCosts_p n_p, n the normal force of usable point p (one cost for each,
  /// or none at all). Infinite if it is unbounded.
  double maximise(std::span<const double> costs, std::span<const double> pointCosts = {});

  /// The last solution: s_i; the force on the upper block in the point's frame for each usable point; and displacements of the
  /// blocks ([6 blocks], translation and rotation about the centre), which are the dual values of the equilibrium rows.
  [[nodiscard]] double variableLoad(std::size_t i) const;
  [[nodiscard]] std::vector<Vec3> forces() const;
  [[nodiscard]] Eigen::VectorXd prices() const;

 private:
  struct Solver;
  std::unique_ptr<Solver> solver_;
};

/// Whether forces that are all parallel to `gravity` balance it, at those of the points `usable` whose friction cone contains
/// that direction. Sufficient, not necessary, for feasibility of the linear program above. With one unknown a point it is some
/// ten times cheaper.
bool parallelForcesBalance(const StaticsModel& model, std::span<const std::size_t> usable, const Vec3& gravity);

}  // namespace springtower
