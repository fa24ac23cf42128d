// The kernels of a step, each alone, on one tower of 54 blocks (in the second level cache) and on 64 towers (not in it). Items
// are springs, contact points, blocks or pairs; bytes are what a kernel has to read and write once. `flops` counts additions,
// multiplications, divisions and roots as the source has them; comparisons and selections are left out.

#include "bench/towers.h"
#include "narrowphase/crossing.h"
#include "narrowphase/manifold.h"
#include "narrowphase/separation.h"
#include "solver/block/affine.h"
#include "solver/block/springs.h"
#include "solver/contact/evaluate_forces.h"
#include "solver/contact/query.h"
#include "solver/contact/update.h"
#include "solver/explicit/leapfrog.h"
#include "solver/law/contact_force.h"
#include "solver/sleep/rest.h"
#include "solver/world/island_step.h"

#include <benchmark/benchmark.h>
#include <cstdint>
#include <span>
#include <vector>

namespace springtower {
namespace {

constexpr double kSpringFlops = 33.0;                        // difference 3, length 6, inverse 1, rate 9, force 8, sums 6
constexpr double kSpreadFlops = 72.0;                        // of a block: contact forces onto corners, 3 for each coordinate
constexpr double kPointFlops = 189.0;                        // places and speeds 58, law 101, sums 30
constexpr double kPairFlops = 78.0;                          // of a manifold: its faces and what is given to its blocks
constexpr double kFrameFlops = 138.0 + 66.0;                 // of a block: affine parts of places and speeds 66 each, frame 72
constexpr double kAccelerationFlops = 75.0;                  // of a block, each coordinate: sum 7, common part 2, corners 16
constexpr double kCornerBytes = 3.0 * 8.0 * sizeof(double);  // a block's corners, one vector each
constexpr double kSpringBytes = 3.0 * 7.0 * sizeof(double);  // a block's rest lengths, stiffnesses and dashpots

void rate(benchmark::State& run, double items, double flops, double bytes) {
  const auto iterations = static_cast<double>(run.iterations());
  run.SetItemsProcessed(static_cast<std::int64_t>(iterations * items));
  run.SetBytesProcessed(static_cast<std::int64_t>(iterations * bytes));
  if (flops > 0.0) run.counters["flops"] = benchmark::Counter(iterations * flops, benchmark::Counter::kIsRate);
}

int framesFor(const benchmark::State& run) {
  return run.range(0) == 1 ? 60 : 3;
}

void springs(benchmark::State& run) {
  Simulation s = startedTowers(static_cast<int>(run.range(0)), framesFor(run));
  const std::vector<std::int32_t> blocks = allBlocks(s.model.blockCount());
  for (auto iteration : run) {
    springForces(s.model, s.state, blocks, s.engine->scratch.contactForce, s.engine->memo.force);
    benchmark::ClobberMemory();
  }
  const auto count = static_cast<double>(blocks.size());
  rate(run, count * kSprings, count * (kSprings * kSpringFlops + kSpreadFlops),
       count * (3.0 * kCornerBytes + kSpringBytes + sizeof(AffineField)));
}

void frames(benchmark::State& run) {
  Simulation s = startedTowers(static_cast<int>(run.range(0)), framesFor(run));
  const std::vector<std::int32_t> blocks = allBlocks(s.model.blockCount());
  for (auto iteration : run) {
    computeFrames(s.state.position, blocks, s.engine->memo.frames);
    computeMotions(s.state.velocity, blocks, s.engine->memo.motion);
    benchmark::ClobberMemory();
  }
  const auto count = static_cast<double>(blocks.size());
  rate(run, count, count * kFrameFlops, count * (2.0 * kCornerBytes + sizeof(BlockFrame) + sizeof(AffineField)));
}

// All touching manifolds as a step evaluates them, with their memory written back.
void contacts(benchmark::State& run) {
  Simulation s = startedTowers(static_cast<int>(run.range(0)), framesFor(run));
  Engine& engine = *s.engine;
  const ContactLaw law = contactLaw(s);
  const auto side = [&](std::int32_t block) -> ContactSide {
    if (block < 0) return {};
    const auto b = static_cast<std::size_t>(block);
    return {&engine.memo.frames[b], &engine.memo.motion[b], &engine.memo.motion[b]};
  };
  double points = 0.0;
  double pairs = 0.0;
  for (std::size_t at = 0; at < engine.pairs.size(); ++at) {
    points += contactOf(engine, at).count;
    pairs += engine.pairs.touches(at) ? 1.0 : 0.0;
  }
  PairForce force;
  for (auto iteration : run) {
    for (std::size_t at = 0; at < engine.pairs.size(); ++at) {
      if (!engine.pairs.touches(at)) continue;
      const ContactView contact = contactOf(engine, at);
      const PointRows kept = engine.contacts.points(engine.pairs.contact[at]);
      manifoldForces(contact, side(contact.upper), side(contact.lower), law, {}, kBlockMass_kg, &kept, force);
      benchmark::DoNotOptimize(force);
    }
  }
  // Ten numbers a point are read and eight written; of each pair its names, two frames, two motions and its forces.
  const double perPair = 2.0 * (sizeof(BlockFrame) + sizeof(AffineField)) + sizeof(PairForce) + 16.0;
  rate(run, points, points * kPointFlops + pairs * kPairFlops, points * 18.0 * sizeof(double) + pairs * perPair);
}

// One island's step through the frame it is in.
IslandStep islandStep(Simulation& s, Counters& counters, StageTimes& times) {
  Engine& engine = *s.engine;
  const auto pairs = static_cast<std::size_t>(engine.memo.pairStart[1]);
  IslandStep step{s,
                  engine,
                  engine.memo.islands.island(0),
                  std::span<const std::int32_t>(engine.memo.islandPairs).first(pairs),
                  counters,
                  times,
                  contactLaw(s)};
  step.drift_s = engine.memo.blockHistory[static_cast<std::size_t>(step.blocks.front())].lastExplicitStep_s;
  step.kick_s = step.drift_s;
  step.advance_s = step.drift_s;
  step.gravity = s.scene.gravity.at(s.time_s);
  return step;
}

// Forces, accelerations, new velocities and positions of a tower that stands: what a step takes without looking for contacts.
void explicitStep(benchmark::State& run) {
  Simulation s = startedTowers(1, 60);
  Counters counters;
  StageTimes times;
  IslandStep step = islandStep(s, counters, times);
  for (auto iteration : run) stepSemiImplicitEuler(step);
  const auto count = static_cast<double>(step.blocks.size());
  rate(run, count, 0.0, count * 6.0 * kCornerBytes);
}

void accelerations(benchmark::State& run) {
  Simulation s = startedTowers(1, 60);
  Counters counters;
  StageTimes times;
  const IslandStep step = islandStep(s, counters, times);
  double acceleration[3][kCorners];
  for (auto iteration : run) {
    for (const std::int32_t block : step.blocks) {
      accelerate(step, static_cast<std::size_t>(block), acceleration);
      benchmark::DoNotOptimize(acceleration);
    }
  }
  const auto count = static_cast<double>(step.blocks.size());
  rate(run, count, count * kAccelerationFlops, count * kCornerBytes);
}

// What a step costs besides its forces when nothing comes near anything new: paths, margins, manifolds that have not moved.
void watchedPairs(benchmark::State& run) {
  Simulation s = startedTowers(1, 60);
  Counters counters;
  StageTimes times;
  IslandStep step = islandStep(s, counters, times);
  s.engine->memo.previous = s.state.position;
  const RefreshTravel renewal = refreshTravelOfExplicitSteps(s);
  for (auto iteration : run) benchmark::DoNotOptimize(updateContacts(step, renewal));
  const auto pairs = static_cast<double>(step.pairs.size());
  rate(run, pairs, 0.0, pairs * 32.0 + static_cast<double>(step.blocks.size()) * 2.0 * kCornerBytes);
}

void restJudgement(benchmark::State& run) {
  Simulation s = startedTowers(static_cast<int>(run.range(0)), framesFor(run));
  for (auto iteration : run) updateRest(s);
  const auto count = static_cast<double>(s.model.blockCount());
  rate(run, count, 0.0, count * (2.0 * kCornerBytes + sizeof(SleepWindow)));
}

// The touching pairs of two blocks of a tower.
std::vector<ManifoldShape> facePairs(const Simulation& s) {
  std::vector<ManifoldShape> pairs;
  for (std::size_t at = 0; at < s.engine->pairs.size(); ++at) {
    const ContactView contact = contactOf(*s.engine, at);
    if (contact.phase == PairPhase::face && contact.lower >= 0) pairs.push_back(contact);
  }
  return pairs;
}

void separation(benchmark::State& run) {
  const Simulation s = startedTowers(1, 60);
  const std::vector<ManifoldShape> pairs = facePairs(s);
  const auto corners = [&](std::int32_t block) { return cornersOf(s.state.position, static_cast<std::size_t>(block)); };
  for (auto iteration : run) {
    for (const ManifoldShape& pair : pairs) {
      benchmark::DoNotOptimize(findSeparation(corners(pair.upper), corners(pair.lower)));
    }
  }
  rate(run, static_cast<double>(pairs.size()), 0.0, static_cast<double>(pairs.size()) * 2.0 * kCornerBytes);
}

void manifoldBuild(benchmark::State& run) {
  const Simulation s = startedTowers(1, 60);
  const std::vector<ManifoldShape> pairs = facePairs(s);
  const auto corners = [&](std::int32_t block) { return cornersOf(s.state.position, static_cast<std::size_t>(block)); };
  constexpr ManifoldLimits kLimits{1e-4, 1e-3};
  for (auto iteration : run) {
    for (const ManifoldShape& old : pairs) {
      Manifold fresh;
      buildFaceManifold(corners(old.upper), corners(old.lower), old.incidentFace, old.referenceFace, kLimits, fresh);
      benchmark::DoNotOptimize(fresh);
    }
  }
  rate(run, static_cast<double>(pairs.size()), 0.0,
       static_cast<double>(pairs.size()) * (2.0 * kCornerBytes + static_cast<double>(sizeof(Manifold))));
}

// Two crossed blocks, the upper one sinking by `sink_m` from 0.1 mm above the lower: all 336 pairs of features in the report's
// stages. With 0.05 mm they stay apart, with 0.2 mm they meet.
void cubicTests(benchmark::State& run, double sink_m) {
  MotionState start = startedTowers(1, 1).state;
  const std::size_t lower = 0;
  const std::size_t upper = 3;  // of the row above
  const double gap = start.position.at(upper, 0).z() - start.position.at(lower, 4).z();
  for (std::size_t c = 0; c < kCorners; ++c)
    start.position.add(upper, c, Vec3(1e-4, 2e-4, 1e-4 - gap + 1e-6 * static_cast<double>(c)));
  ParticleArray end = start.position;
  for (std::size_t c = 0; c < kCorners; ++c) end.add(upper, c, Vec3(1e-5, 2e-5, -sink_m));
  const MovingBlock a{cornersOf(start.position, upper), cornersOf(end, upper)};
  const MovingBlock b{cornersOf(start.position, lower), cornersOf(end, lower)};
  Counters counters;
  bool met = false;
  for (auto iteration : run) {
    met = featuresMeet(a, b, counters);
    benchmark::DoNotOptimize(met);
  }
  const auto calls = static_cast<double>(run.iterations());
  run.SetItemsProcessed(run.iterations());
  run.SetBytesProcessed(static_cast<std::int64_t>(calls * 4.0 * kCornerBytes));
  run.counters["met"] = met ? 1.0 : 0.0;
  run.counters["planes"] = static_cast<double>(counters.boxOverlaps) / calls;
  run.counters["full"] = static_cast<double>(counters.cubicTests) / calls;
}

BENCHMARK(springs)->Arg(1)->Arg(64);
BENCHMARK(frames)->Arg(1)->Arg(64);
BENCHMARK(contacts)->Arg(1)->Arg(64);
BENCHMARK(explicitStep);
BENCHMARK(accelerations);
BENCHMARK(watchedPairs);
BENCHMARK(restJudgement)->Arg(1)->Arg(64);
BENCHMARK(separation);
BENCHMARK(manifoldBuild);
BENCHMARK_CAPTURE(cubicTests, apart, 5e-5);
BENCHMARK_CAPTURE(cubicTests, meeting, 2e-4);

}  // namespace
}  // namespace springtower
