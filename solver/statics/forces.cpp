#include "solver/statics/forces.h"

#include "core/tuning.h"

#include <Eigen/SparseCholesky>
#include <cmath>

namespace springtower {
namespace {

// Nearest point of the cone |tangent| <= friction * normal, and its derivative.
struct Projection {
  Vec3 value = Vec3::Zero();
  Eigen::Matrix3d derivative = Eigen::Matrix3d::Zero();
};

Projection project(const Vec3& force, double friction) {
  const double normal = force[0];
  const double tangent = force.tail<2>().norm();
  if (tangent <= friction * normal) return {force, Eigen::Matrix3d::Identity()};
  if (friction * tangent <= -normal) return {};
  const double height = (normal + friction * tangent) / (1.0 + friction * friction);
  const Eigen::Vector2d along = force.tail<2>() / tangent;
  const Vec3 edge(1.0, friction * along.x(), friction * along.y());
  const Vec3 sideways(0.0, -along.y(), along.x());
  return {height * edge, edge * edge.transpose() / (1.0 + friction * friction) +
                             (friction * height / tangent) * sideways * sideways.transpose()};
}

class Dual {
 public:
  Dual(const StaticsModel& model, std::span<const std::size_t> usable, const Eigen::VectorXd& load)
      : model_(model), usable_(usable), load_(load), forces_(usable.size()), derivatives_(usable.size()) {
    for (const std::size_t p : usable) {
      const ForcePoint& point = model.points[p];
      upper_.push_back(model.wrench(point, true));
      lower_.push_back(point.lower >= 0 ? model.wrench(point, false) : Eigen::Matrix<double, 6, 3>::Zero());
    }
  }

  // The function to be minimised; also sets forces and imbalance at these displacements.
  double evaluate(const Eigen::VectorXd& displacement) {
    imbalance_ = load_;
    double value = load_.dot(displacement);
    for (std::size_t i = 0; i < usable_.size(); ++i) {
      const ForcePoint& point = model_.points[usable_[i]];
      Vec3 spring = upper_[i].transpose() * displacement.segment<6>(6 * point.upper);
      if (point.lower >= 0) spring += lower_[i].transpose() * displacement.segment<6>(6 * point.lower);
      const Projection projection = project(spring, point.friction);
      forces_[i] = projection.value;
      derivatives_[i] = projection.derivative;
      value += 0.5 * projection.value.squaredNorm();
      imbalance_.segment<6>(6 * point.upper) += upper_[i] * projection.value;
      if (point.lower >= 0) imbalance_.segment<6>(6 * point.lower) += lower_[i] * projection.value;
    }
    return value;
  }

  Eigen::VectorXd newtonStep() {
    std::vector<Eigen::Triplet<double>> entries;
    const auto add = [&](std::int32_t row, std::int32_t column, const Eigen::Matrix<double, 6, 6>& block) {
      for (int i = 0; i < 6; ++i) {
        for (int j = 0; j < 6; ++j) entries.emplace_back(6 * row + i, 6 * column + j, block(i, j));
      }
    };
    for (int i = 0; i < imbalance_.size(); ++i) entries.emplace_back(i, i, tuning::kForceRegularisation);
    for (std::size_t i = 0; i < usable_.size(); ++i) {
      const ForcePoint& point = model_.points[usable_[i]];
      add(point.upper, point.upper, upper_[i] * derivatives_[i] * upper_[i].transpose());
      if (point.lower < 0) continue;
      add(point.lower, point.lower, lower_[i] * derivatives_[i] * lower_[i].transpose());
      const Eigen::Matrix<double, 6, 6> between = upper_[i] * derivatives_[i] * lower_[i].transpose();
      add(point.upper, point.lower, between);
      add(point.lower, point.upper, between.transpose());
    }
    Eigen::SparseMatrix<double> matrix(imbalance_.size(), imbalance_.size());
    matrix.setFromTriplets(entries.begin(), entries.end());
    solver_.compute(matrix);
    return solver_.solve(-imbalance_);
  }

  [[nodiscard]] const Eigen::VectorXd& imbalance() const { return imbalance_; }
  [[nodiscard]] const std::vector<Vec3>& forces() const { return forces_; }

  // Derivatives as if every point stuck: for the first step from rest, where all cones are at their tips.
  void setAllSticking() { derivatives_.assign(derivatives_.size(), Eigen::Matrix3d::Identity()); }

 private:
  const StaticsModel& model_;
  std::span<const std::size_t> usable_;
  const Eigen::VectorXd& load_;
  std::vector<Eigen::Matrix<double, 6, 3>> upper_;
  std::vector<Eigen::Matrix<double, 6, 3>> lower_;
  std::vector<Vec3> forces_;
  std::vector<Eigen::Matrix3d> derivatives_;
  Eigen::VectorXd imbalance_;
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver_;
};

}  // namespace

std::optional<std::vector<Vec3>> leastSquaresForces(const StaticsModel& model, std::span<const std::size_t> usable,
                                                    const Eigen::VectorXd& load) {
  Dual dual(model, usable, load);
  Eigen::VectorXd displacement = Eigen::VectorXd::Zero(load.size());
  double value = dual.evaluate(displacement);
  dual.setAllSticking();
  for (int step = 0; step < tuning::kMaxForceRefinements; ++step) {
    const Eigen::VectorXd imbalance = dual.imbalance();
    if (imbalance.cwiseAbs().maxCoeff() <= tuning::kMaxForceImbalance) return dual.forces();
    const Eigen::VectorXd direction = dual.newtonStep();
    const double slope = imbalance.dot(direction);
    double length = 1.0;
    for (;; length *= 0.5) {
      if (!(length > tuning::kMinForceStep)) return {};
      const double next = dual.evaluate(displacement + length * direction);
      // Near convergence the value no longer resolves the progress; the imbalance does.
      const bool balances = dual.imbalance().norm() < 0.9 * imbalance.norm() && std::abs(next - value) <= 1e-9 * std::abs(value);
      if (next <= value + tuning::kArmijo * length * slope || balances) {
        value = next;
        break;
      }
    }
    displacement += length * direction;
  }
  return {};
}

}  // namespace springtower
