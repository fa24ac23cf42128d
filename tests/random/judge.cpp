#include "tests/random/judge.h"

#include "scenarios/random_scene.h"
#include "solver/hand/grip.h"
#include "solver/law/user_force.h"
#include "solver/metrics/penetration.h"
#include "tests/random/course.h"
#include "tests/support/momenta.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>
#include <utility>
#include <vector>

namespace springtower {
namespace {

constexpr std::uint64_t kFramesToAMomentum = 5;
constexpr double kThreadsShare = 0.25;  // of the limit, for the run on two threads

// NaN where one of them is: what could not be measured is not to pass as small.
double largerOrNan(double a, double b) {
  return std::isnan(a) || a > b ? a : b;
}

// Sum of what the blocks have at the start: kinetic energy, and potential energy above the floor, for which a block that lies on
// it still has half its side. In space at rest there is none: then what one contact of the tolerance's depth would store.
double energyScale_j(const Simulation& simulation, const Energy& start) {
  double scale_j = start.kinetic;
  for (std::size_t b = 0; b < simulation.model.blockCount(); ++b) {
    const double least = 0.5 * simulation.model.dimensions[b].minCoeff();
    const double height = simulation.scene.floor ? std::max(least, centre(simulation.state.position, b).z()) : 0.0;
    scale_j += simulation.model.mass[b] * simulation.scene.gravity.magnitude * height;
  }
  return std::max(scale_j, 0.5 * largestStiffness(simulation.stiffness) * simulation.tolerance_m * simulation.tolerance_m);
}

// What the hand and the scene's forces do to their blocks: the work of a frame is the mean of their forces at both ends times the
// way. The hand's force follows its block: where a blow changes it within a frame, the work is known to half of the change times
// the way only.
class Work {
 public:
  void beforeFrame(const Simulation& simulation) {
    hand_ = gripForce(simulation);
    if (simulation.tether.block != kFloor) {
      place_ = centre(simulation.state.position, index(simulation.tether.block));
      turn_ = orientationOf(simulation.state.position, index(simulation.tether.block));
    }
    places_.clear();
    turns_.clear();
    for (const UserForce& force : simulation.scene.forces) {
      places_.push_back(placeOf(simulation, force));
      turns_.push_back(turnOf(simulation, force));
    }
  }

  void afterFrame(const Simulation& simulation) {
    double done_j = 0.0;
    doubt_j = 0.0;
    if (simulation.tether.block != kFloor) {
      const std::size_t b = index(simulation.tether.block);
      const GripForce now = gripForce(simulation);
      const Eigen::AngleAxisd turned(orientationOf(simulation.state.position, b) * turn_.conjugate());
      done_j += 0.5 * (hand_.force + now.force).dot(centre(simulation.state.position, b) - place_);
      done_j += 0.5 * (hand_.torque + now.torque).dot(turned.axis() * turned.angle());
      doubt_j += 0.5 * (now.force - hand_.force).norm() * (centre(simulation.state.position, b) - place_).norm();
      doubt_j += 0.5 * (now.torque - hand_.torque).norm() * std::abs(turned.angle());
    }
    const double frame_s = simulation.scene.settings.frame_s;
    for (std::size_t f = 0; f < simulation.scene.forces.size(); ++f) {
      const UserForce& force = simulation.scene.forces[f];
      const Load mean = force.meanOver(simulation.time_s - frame_s, simulation.time_s);
      const Eigen::AngleAxisd turned(turnOf(simulation, force) * turns_[f].conjugate());
      done_j += mean.force.dot(placeOf(simulation, force) - places_[f]) + mean.torque.dot(turned.axis() * turned.angle());
    }
    sum_j += done_j;
    put_j += std::abs(done_j);
  }

  double sum_j = 0.0;
  double put_j = 0.0;    // without signs
  double doubt_j = 0.0;  // by how much the work of the last frame may be wrong

 private:
  static Vec3 placeOf(const Simulation& simulation, const UserForce& force) {
    return springtower::placeOf(simulation.model, simulation.state.position, force);
  }
  static Eigen::Quaterniond turnOf(const Simulation& simulation, const UserForce& force) {
    return orientationOf(simulation.state.position, static_cast<std::size_t>(force.block));
  }

  GripForce hand_;
  Vec3 place_ = Vec3::Zero();
  Eigen::Quaterniond turn_ = Eigen::Quaterniond::Identity();
  std::vector<Vec3> places_;
  std::vector<Eigen::Quaterniond> turns_;
};

// Largest rise of the energy above its least value before, less work. It is watched anew after a frame whose work is not known.
class EnergyWatch {
 public:
  void atStart(const Simulation& simulation) {
    least_ = energy(simulation);
    scale_j_ = energyScale_j(simulation, least_);
  }
  void beforeFrame(const Simulation& simulation) { work_.beforeFrame(simulation); }
  void afterFrame(const Simulation& simulation) {
    work_.afterFrame(simulation);
    Energy now = energy(simulation);
    const double rise_j = energyRise(least_, now) - (work_.sum_j - workAtLeast_j_);
    const bool known = !(work_.doubt_j > kMaxEnergyGain * (scale_j_ + work_.put_j));
    if (known || !std::isfinite(rise_j)) {
      most_j_ = largerOrNan(most_j_, std::isfinite(rise_j) ? rise_j : std::numeric_limits<double>::quiet_NaN());
    }
    if (known && !(rise_j < 0.0)) return;
    least_ = std::move(now);
    workAtLeast_j_ = work_.sum_j;
  }
  [[nodiscard]] double gained() const { return most_j_ / (scale_j_ + work_.put_j); }

 private:
  Work work_;
  Energy least_;
  double workAtLeast_j_ = 0.0;
  double scale_j_ = 0.0;
  double most_j_ = 0.0;
};

Vec3 centreOfMass(const Simulation& simulation) {
  Vec3 sum = Vec3::Zero();
  double mass = 0.0;
  for (std::size_t b = 0; b < simulation.model.blockCount(); ++b) {
    sum += simulation.model.mass[b] * centre(simulation.state.position, b);
    mass += simulation.model.mass[b];
  }
  return sum / mass;
}

class MomentumWatch {
 public:
  void atStart(const Simulation& simulation) {
    about_ = centreOfMass(simulation);
    start_ = momentaOf(simulation, about_);
    const std::vector<BlockSpec>& blocks = simulation.scene.blocks;
    const bool anyFixed = std::any_of(blocks.begin(), blocks.end(), [](const BlockSpec& block) { return block.fixed; });
    applies_ = !simulation.scene.floor && simulation.scene.gravity.magnitude == 0.0 && simulation.scene.forces.empty() &&
               simulation.scene.moves.empty() && !anyFixed && start_.linearSum > 0.0;
  }
  void afterFrame(const Simulation& simulation) {
    if (!applies_ || simulation.frame % kFramesToAMomentum != 0) return;
    const Momenta now = momentaOf(simulation, about_);
    linear_ = largerOrNan(linear_, (now.linear - start_.linear).norm() / start_.linearSum);
    angular_ = largerOrNan(angular_, (now.angular - start_.angular).norm() / start_.angularSum);
  }
  [[nodiscard]] bool applies() const { return applies_; }
  [[nodiscard]] double linearLost() const { return linear_; }
  [[nodiscard]] double angularLost() const { return angular_; }

 private:
  Vec3 about_ = Vec3::Zero();
  Momenta start_;
  bool applies_ = false;
  double linear_ = 0.0;
  double angular_ = 0.0;
};

void copyCourse(const Course& course, Record& record) {
  record.frames = course.frames;
  record.simulated_s = course.simulated_s;
  record.processor_s = course.processor_s;
  record.cut = course.cut;
  record.mostSubsteps = course.mostSubsteps;
  record.tolerance_m = course.tolerance_m;
  record.diverged = course.diverged;
  record.stepLimit = course.stepLimit;
  record.notFinite = course.notFinite;
  record.refused = course.refused;
  record.movedMost = course.movedMost;
  record.hash = fmt::format("{:016x}", course.hash);
}

Course playAndMeasure(const Scene& scene, double limit_s, Record& record) {
  EnergyWatch energies;
  MomentumWatch momenta;
  PenetrationWorkspace workspace;
  CourseWatch watch;
  watch.atStart = [&](const Simulation& simulation) {
    energies.atStart(simulation);
    momenta.atStart(simulation);
  };
  watch.beforeFrame = [&](const Simulation& simulation) { energies.beforeFrame(simulation); };
  watch.afterFrame = [&](const Simulation& simulation) {
    energies.afterFrame(simulation);
    momenta.afterFrame(simulation);
    const double depth_m = maxPenetration(simulation.state.position, scene.floor, workspace, simulation.model.fixed).depth;
    record.deepest_m = largerOrNan(record.deepest_m, depth_m);
  };
  Course course = playScene(scene, 1, limit_s, watch);
  copyCourse(course, record);
  // What a driven block does to others is not known from outside.
  record.energyGained = course.frames > 0 && scene.drives.empty() ? energies.gained() : 0.0;
  if (momenta.applies()) {
    record.momentumLost = momenta.linearLost();
    record.angularLost = momenta.angularLost();
  }
  return course;
}

}  // namespace

Record judgeScene(const Scene& scene, const JudgeOptions& options) {
  const auto begin = [&](double limit_s) {
    if (options.beforeRun) options.beforeRun(limit_s);
  };
  Record record;
  record.scene = scene.name;
  record.method = nameOf(scene.settings.method);
  record.blocks = scene.blocks.size();
  record.massRatio = massRatioOf(scene);
  record.leastSide_m = blockHeightOf(scene);
  record.byHand = !scene.moves.empty();
  const auto end = [&] {
    if (options.afterRun) options.afterRun(record);
  };
  begin(options.limit_s);
  const Course first = playAndMeasure(scene, options.limit_s, record);
  end();
  if (!first.refused.empty()) return record;
  if (options.compareThreads) {
    begin(kThreadsShare * options.limit_s);
    record.sameOnTwoThreads = agree(first, playScene(scene, 2, kThreadsShare * options.limit_s));
    end();
  }
  const auto isWhole = [](const Course& course) {
    return !course.cut && course.diverged.empty() && course.stepLimit.empty() && course.notFinite.empty();
  };
  if (!options.compareSleep || !isWhole(first)) return record;
  Scene other = scene;
  other.settings.sleep = scene.settings.sleep == Sleep::off ? Sleep::on : Sleep::off;
  begin(options.limit_s);
  const Course second = playScene(other, 1, options.limit_s);
  if (isWhole(second)) {
    record.sameVerdict = (first.movedMost > kMaxMove) == (second.movedMost > kMaxMove);
  }
  end();
  return record;
}

}  // namespace springtower
