// Contact tangents beyond the symmetric factors, compared with the forces themselves and with a dense solution.

#include "solver/implicit/friction_tangent.h"

#include "core/scene/scene.h"
#include "solver/contact/evaluate_forces.h"
#include "solver/contact/query.h"
#include "solver/frame/inputs.h"
#include "solver/implicit/gmres.h"
#include "solver/implicit/run.h"
#include "solver/implicit/system.h"
#include "solver/world/island_step.h"
#include "solver/world/simulation.h"
#include "tests/support/block_scenes.h"
#include "tests/support/prepare_and_step.h"

#include <Eigen/Dense>
#include <bit>
#include <cmath>
#include <gtest/gtest.h>
#include <random>
#include <vector>

namespace springtower {
namespace {

constexpr std::size_t kDrawn = 4;  // middle block of the middle row

// Three rows; the middle block of the second is drawn with 1.5 times the friction limit, until it slides between its neighbours.
struct DrawnBlock {
  DrawnBlock() {
    step.drift_s = 0.25 * simulation.scene.settings.frame_s;
    effective_s = kBdf2 * step.drift_s;
    evaluateTrialForces(step);
    island().trialIsAhead = true;
    island().isNear = true;
  }

  static Scene scene() {
    Scene scene = towerScene(3);
    scene.settings.sleep = Sleep::off;
    scene.settings.method = Method::implicit;
    const BlockSpec& drawn = scene.blocks[kDrawn];
    const double held_n = 3.0 * scene.staticFriction * drawn.mass * kStandardGravity_m_s2;
    scene.forces.push_back(
        constantForce(static_cast<int>(kDrawn), -1, 1.5 * held_n * (drawn.orientation * Vec3::UnitX()), 0.5, 1.0));
    return scene;
  }

  static Simulation sliding() {
    Simulation simulation(scene());
    stepFor(simulation, 0.55);
    return simulation;
  }

  void findActive() {
    island().active.resize(island().touching.size());
    for (std::size_t at = 0; at < island().touching.size(); ++at) island().active[at] = activeSetBits(step, island(), at);
  }

  // The tangents of the present active set.
  void findTangentsNow() {
    findActive();
    findTangents(step, island(), effective_s);
  }

  // Factorises for the present active set.
  bool factorise() {
    findActive();
    island().mask = island().active;
    setJacobians(step, effective_s);
    return assemble(step, island(), effective_s);
  }

  // The tangents' forces at unit displacements of one degree of freedom each, by columns.
  Eigen::MatrixXd tangentMatrix() {
    const auto size = static_cast<Eigen::Index>(kNodeSize * step.blocks.size());
    Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(size, size);
    for (Eigen::Index i = 0; i < size; ++i) {
      const Eigen::VectorXd unit = Eigen::VectorXd::Unit(size, i);
      addTangentForces(island().tangents, {unit.data(), static_cast<std::size_t>(size)},
                       {matrix.col(i).data(), static_cast<std::size_t>(size)});
    }
    return matrix;
  }

  NewtonSystem& island() { return simulation.engine->memo.newtonSystems.of(0); }

  // Moves the step's end by displacements [node][12], and evaluates the forces there.
  void move(const std::vector<double>& displacement) {
    Simulation& s = simulation;
    for (const std::int32_t block : step.blocks) {
      const auto b = static_cast<std::size_t>(block);
      const double* d = displacement.data() + kNodeSize * static_cast<std::size_t>(s.engine->scratch.nodeOf[b]);
      for (std::size_t a = 0; a < 3; ++a) {
        for (std::size_t c = 0; c < kCorners; ++c) {
          double moved = d[a];
          for (std::size_t side = 0; side < 3; ++side) moved += 0.5 * cornerSide(c, side) * d[3 + 3 * side + a];
          s.state.position.values(a, b)[c] += moved;
          s.state.velocity.values(a, b)[c] += moved / effective_s;
        }
        AffineField& carried = s.engine->memo.carriedMotion[b];
        carried.centre[a] += d[a] / step.drift_s;
        for (std::size_t side = 0; side < 3; ++side) carried.side[side][a] += d[3 + 3 * side + a] / step.drift_s;
      }
    }
    evaluateTrialForces(step);
  }

  // Contact forces on the blocks if the step's end were moved by displacements; both [node][12].
  std::vector<double> contactForcesAt(const std::vector<double>& displacement) {
    Simulation& s = simulation;
    const auto place = s.state;
    const std::vector<AffineField> carried = s.engine->memo.carriedMotion;
    move(displacement);
    std::vector<double> force(displacement.size());
    for (const std::int32_t block : step.blocks) {
      const auto b = static_cast<std::size_t>(block);
      const AffineField& on = s.engine->scratch.contactForce[b];
      double* f = force.data() + kNodeSize * static_cast<std::size_t>(s.engine->scratch.nodeOf[b]);
      for (std::size_t a = 0; a < 3; ++a) {
        f[a] = on.centre[a];
        for (std::size_t side = 0; side < 3; ++side) f[3 + 3 * side + a] = on.side[side][a];
      }
    }
    s.state = place;
    s.engine->memo.carriedMotion = carried;
    return force;
  }

  Simulation simulation = sliding();
  Counters counters;
  StageTimes times;
  IslandStep step{
      simulation, *simulation.engine,    simulation.engine->memo.islands.island(0), simulation.engine->memo.islandPairs, counters,
      times,      contactLaw(simulation)};
  double effective_s = 0.0;
};

std::vector<double> randomVector(std::size_t count, double size) {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> number(-size, size);
  std::vector<double> values(count);
  for (double& value : values) value = number(random);
  return values;
}

// With factors without any contact the tangents are the whole derivative of the contact forces, including dashpots and the
// dependence of friction on the normal force. Central differences over a distance that is small against the depth of the
// contacts, some tenths of a micrometre: within a thousandth of the largest force, far below the contribution of friction, 0.4 of
// the normal forces.
void expectTangentsToBeTheDerivative(DrawnBlock& drawn, double way_m) {
  NewtonSystem& island = drawn.island();
  island.mask.assign(island.touching.size(), 0);
  island.factorTangents.clear();
  drawn.findTangentsNow();
  const std::vector<double> way = randomVector(kNodeSize * drawn.step.blocks.size(), way_m);
  std::vector<double> back(way.size());
  for (std::size_t i = 0; i < way.size(); ++i) back[i] = -way[i];
  const std::vector<double> after = drawn.contactForcesAt(way);
  const std::vector<double> before = drawn.contactForcesAt(back);
  std::vector<double> told(way.size());
  addTangentForces(island.tangents, way, told);
  double largest = 0.0;
  for (const double force : told) largest = std::max(largest, std::abs(force));
  for (std::size_t i = 0; i < way.size(); ++i) EXPECT_NEAR(told[i], 0.5 * (after[i] - before[i]), 1e-3 * largest) << "row " << i;
}

TEST(ContactTangent, IsTheDerivativeOfTheContactsForces) {
  DrawnBlock drawn;
  int sliding = 0;
  for (std::size_t at = 0; at < drawn.island().touching.size(); ++at)
    sliding += anySlides(activeSetBits(drawn.step, drawn.island(), at)) ? 1 : 0;
  ASSERT_GE(sliding, 6) << "the block slides on three and under three";
  expectTangentsToBeTheDerivative(drawn, 1e-9);
}

// A lifted block: its points still touch, but damping cancels their springs while they separate.
TEST(ContactTangent, ATouchingPointThatDoesNotPushResistsNothing) {
  constexpr std::size_t kLifted = 7;  // the middle block of the top row
  constexpr double kLift_m = 6.5e-6;  // of 8 micrometres of depth of its points
  DrawnBlock drawn;
  const Engine& engine = *drawn.simulation.engine;
  std::vector<double> lift(kNodeSize * drawn.step.blocks.size());
  lift[kNodeSize * static_cast<std::size_t>(engine.scratch.nodeOf[kLifted]) + 2] = kLift_m;
  drawn.move(lift);
  std::ptrdiff_t unpressed = 0;
  for (const std::int32_t pair : drawn.island().touching) {
    const auto at = static_cast<std::size_t>(pair);
    const ContactView trial = trialOf(engine, at, contactOf(engine, at));
    for (std::size_t i = 0; i < static_cast<std::size_t>(trial.count); ++i)
      unpressed += touchingAt(trial, i) == kTouchingWithoutForce ? 1 : 0;
  }
  ASSERT_GE(unpressed, 2);
  expectTangentsToBeTheDerivative(drawn, 1e-9);
}

// A lifted block that comes down again before its springs have forgotten how deep they were: the Maxwell branch would pull, so
// only the damping resists. With the stiffness of the springs as well, Newton's iteration took a dozen factorisations.
TEST(ContactTangent, OfAPointWhoseSpringIsSpentOnlyTheDampingResists) {
  constexpr std::int32_t kLifted = 7;  // the middle block of the top row
  constexpr double kLift_m = 6.5e-6;   // of 8 micrometres of depth of its points
  constexpr double kSpeed_m_s = 1e-4;  // reaches less than the depth left within the step
  DrawnBlock drawn;
  std::vector<double> lift(kNodeSize * drawn.step.blocks.size());
  lift[kNodeSize * static_cast<std::size_t>(drawn.simulation.engine->scratch.nodeOf[kLifted]) + 2] = kLift_m;
  drawn.move(lift);
  for (std::size_t c = 0; c < kCorners; ++c) {
    const Vec3 now = drawn.simulation.state.velocity.at(kLifted, c);
    drawn.simulation.state.velocity.add(kLifted, c, Vec3(0.0, 0.0, -kSpeed_m_s) - now);
  }
  drawn.move(std::vector<double>(lift.size()));
  int spent = 0;
  for (std::size_t at = 0; at < drawn.island().touching.size(); ++at)
    spent += std::popcount(activeSetBits(drawn.step, drawn.island(), at) & kAllPoints * kSpentBit);
  ASSERT_GE(spent, 2);
  expectTangentsToBeTheDerivative(drawn, 1e-9);
}

// A block that lands on its supports within the step: at its end the force of each point is that of a point that has been closing
// since it reached the surface, limited by its depth. A dashpot with the full closing speed would exert the same force at zero
// depth, here two and a half times as large, and no position of the block would balance a force between zero and that.
TEST(ContactTangent, APointThatIsReachedInTheStepPushesFromNothing) {
  constexpr std::int32_t kLanding = 7;  // the middle block of the top row
  constexpr double kLift_m = 6.5e-6;    // of 8 micrometres of depth of its points
  constexpr double kSpeed_m_s = 0.1;
  DrawnBlock drawn;
  Engine& engine = *drawn.simulation.engine;
  for (const std::int32_t pair : drawn.island().touching) {
    const auto at = static_cast<std::size_t>(pair);
    const ManifoldShape shape = shapeOf(engine, at);
    if (shape.upper != kLanding && shape.lower != kLanding) continue;
    for (PointRow* row : engine.contacts.points(engine.pairs.contact[at])) {
      if (row != nullptr) *row = PointRow{};
    }
  }
  std::vector<double> lift(kNodeSize * drawn.step.blocks.size());
  lift[kNodeSize * static_cast<std::size_t>(engine.scratch.nodeOf[static_cast<std::size_t>(kLanding)]) + 2] = kLift_m;
  drawn.move(lift);
  for (std::size_t c = 0; c < kCorners; ++c) drawn.simulation.state.velocity.add(kLanding, c, Vec3(0.0, 0.0, -kSpeed_m_s));
  drawn.move(std::vector<double>(lift.size()));

  const ContactLaw& law = drawn.step.law;
  double most = 0.0;
  int pushing = 0;
  for (const std::int32_t pair : drawn.island().touching) {
    const ContactView manifold = contactOf(engine, static_cast<std::size_t>(pair));
    if (manifold.upper != kLanding && manifold.lower != kLanding) continue;
    const PointForces points = forcesNow(drawn.simulation, manifold);
    for (std::size_t i = 0; i < static_cast<std::size_t>(manifold.count); ++i) {
      if (!(points.depth[i] > 0.0)) continue;
      ++pushing;
      most += law.stiffnessOf(manifold.upper, manifold.lower) * points.depth[i] *
              (1.0 + law.maxwellRatio + law.dampingTime_s / drawn.step.drift_s);
    }
  }
  ASSERT_GE(pushing, 4);
  EXPECT_GT(engine.scratch.contactForce[kLanding].centre[2], 0.5 * most);
  EXPECT_LT(engine.scratch.contactForce[kLanding].centre[2], 1.01 * most) << "of which friction lifts by what the block leans";
  expectTangentsToBeTheDerivative(drawn, 1e-10);
}

// The difference between the tangents in the factors and those of the contacts is the unsymmetric part only.
TEST(ContactTangent, FactorsLackWhatIsNotSymmetric) {
  DrawnBlock drawn;
  NewtonSystem& island = drawn.island();
  ASSERT_TRUE(drawn.factorise());
  ASSERT_FALSE(island.factorTangents.empty());
  drawn.findTangentsNow();
  const Eigen::MatrixXd lacking = drawn.tangentMatrix();
  const double symmetric = (0.5 * (lacking + lacking.transpose())).norm();
  const double rest = (0.5 * (lacking - lacking.transpose())).norm();
  EXPECT_GT(rest, 0.0);
  // s n^T, with s across n, is half symmetric and half not.
  EXPECT_NEAR(symmetric, rest, 0.01 * rest);
}

// The solution with tangents against a dense one: the residual is within the allowed one, and without tangents ten times as
// large.
TEST(CoupledSolve, SolvesWithTangents) {
  DrawnBlock drawn;
  NewtonSystem& island = drawn.island();
  ASSERT_TRUE(drawn.factorise());
  drawn.findTangentsNow();
  const std::size_t count = kNodeSize * drawn.step.blocks.size();
  const auto size = static_cast<Eigen::Index>(count);
  const Eigen::MatrixXd tangent = drawn.tangentMatrix();
  Eigen::MatrixXd inverse(size, size);  // of the factorised matrix
  for (Eigen::Index i = 0; i < size; ++i) {
    island.affine.assign(count, 0.0);
    island.affine[static_cast<std::size_t>(i)] = 1.0;
    solve(drawn.step, island);
    inverse.col(i) = Eigen::Map<const Eigen::VectorXd>(island.affine.data(), size);
  }
  const std::vector<double> force = randomVector(count, 1e-2);
  const Eigen::VectorXd right = Eigen::Map<const Eigen::VectorXd>(force.data(), size);
  const Eigen::PartialPivLU<Eigen::MatrixXd> matrix(inverse);
  const auto left = [&](const Eigen::VectorXd& moved) { return (right - matrix.solve(moved) + tangent * moved).norm(); };
  constexpr double kAllowed_n = 1e-4;
  EXPECT_GT(left(inverse * right), 10.0 * kAllowed_n);
  island.affine = force;
  EXPECT_TRUE(solveCoupled(drawn.step, island, {tuning::kGmresRelativeTolerance, kAllowed_n}));
  EXPECT_LT(left(Eigen::Map<const Eigen::VectorXd>(island.affine.data(), size)), 2.0 * kAllowed_n);  // in float
}

// Sets a force that draws a block steadily: the previous force, plus half of the correction of its speed within a frame.
void draw(Simulation& simulation, int block, const Vec3& way, double& held_n) {
  constexpr double kSpeed_m_s = 0.04;
  const double frame_s = simulation.scene.settings.frame_s;
  const auto b = static_cast<std::size_t>(block);
  const double missing_n = simulation.model.mass[b] / frame_s * (kSpeed_m_s - centre(simulation.state.velocity, b).dot(way));
  held_n += 0.2 * missing_n;
  setOnlyForce(simulation, forceForOneFrame(simulation, b, (held_n + 0.5 * missing_n) * way));
  prepareAndStep(simulation);
}

// Friction on a drawn block depends on the loads on it, which no symmetric matrix represents: with that alone a step took three
// iterations and a frame more than one factorisation. With the contact tangents beside the factors most steps take one iteration.
TEST(CoupledSolve, ADrawnBlockTakesHardlyMoreThanAnIterationAStep) {
  constexpr int kBlock = 28;  // the middle of row 10
  constexpr int kFrames = 24;
  Scene scene = towerScene(18);
  scene.settings.sleep = Sleep::off;
  scene.settings.method = Method::implicit;
  scene.settings.tolerance_m = 1e-5;
  scene.settings.substeps = 4;
  scene.settings.allowUnstable = true;
  const Vec3 way = scene.blocks[kBlock].orientation * Vec3::UnitX();
  Simulation simulation(scene);
  stepFor(simulation, 1.0);
  const auto drawn = [&] { return centre(simulation.state.position, kBlock).dot(way); };
  const double lay = drawn();
  double held_n = 0.0;
  for (int frame = 0; frame < 300 && drawn() - lay < 0.005; ++frame) draw(simulation, kBlock, way, held_n);
  const double start = drawn();
  const Counters before = simulation.counters;
  for (int frame = 0; frame < kFrames; ++frame) draw(simulation, kBlock, way, held_n);
  EXPECT_NEAR(drawn() - start, 0.04 * kFrames * scene.settings.frame_s, 0.002) << "it slides all the time";
  const auto steps = static_cast<double>(simulation.counters.implicitSteps - before.implicitSteps);
  EXPECT_EQ(steps, 4.0 * kFrames);
  EXPECT_LE(static_cast<double>(simulation.counters.implicitIterations - before.implicitIterations), 1.5 * steps);
  EXPECT_LE(simulation.counters.factorisations - before.factorisations, kFrames / 3U);
}

}  // namespace
}  // namespace springtower
