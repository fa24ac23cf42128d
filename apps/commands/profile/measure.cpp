#include "apps/commands/profile/measure.h"

#include "apps/commands/profile/falls.h"
#include "apps/commands/profile/peer_figures.h"
#include "apps/commands/profile/scene.h"
#include "apps/common/interruption.h"
#include "core/error.h"
#include "core/processor_time.h"
#include "scenarios/recorded/recorded_game.h"
#include "solver/metrics/measures.h"
#include "solver/metrics/penetration.h"
#include "solver/runner/run.h"
#include "solver/world/memory_use.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <memory>
#include <oneapi/tbb/global_control.h>

namespace springtower {
namespace {

using Clock = std::chrono::steady_clock;

// A sleeping scene's frame is shorter than the reading of a clock: so many are timed together.
constexpr int kSleepingFrames = 1000;

double secondsBetween(Clock::time_point start, Clock::time_point end) {
  return std::chrono::duration<double>(end - start).count();
}

bool samePreparation(const ProfileCase& a, const ProfileCase& b) {
  return a.scene == b.scene && a.rows == b.rows && a.towers == b.towers && a.method == b.method && a.inertia == b.inertia &&
         a.tolerance_m == b.tolerance_m && a.named == b.named;
}

// A case under way.
struct Measured {
  PreparedScene* scene = nullptr;
  ProfileResult* result = nullptr;
  std::vector<double> wall_ms;       // least over the samples, [frames]
  std::vector<double> processor_ms;  // likewise
  std::vector<double> rawWall_ms;
  std::vector<StageTimes> stages;  // of each frame in the sample in which it took the least wall time, [frames]
  Counters before;                 // at the start of the sample's timed frames
  std::uint64_t substeps = 0;
};

FrameCost costOf(const std::vector<double>& values) {
  return {quantile(values, 0.5), quantile(values, 0.99), quantile(values, 1.0)};
}

TracedFrame tracedFrame(const Simulation& simulation, const StageTimes& stages, const Counters& counters, double start_s,
                        double wall_s) {
  TracedFrame frame;
  frame.start_us = 1e6 * start_s;
  frame.duration_us = 1e6 * wall_s;
  for (std::size_t i = 0; i < kStages; ++i) frame.stage_us[i] = 1e6 * (simulation.stageTimes.seconds[i] - stages.seconds[i]);
  frame.substeps = simulation.substeps;
  frame.contactEvaluations = simulation.counters.contactEvaluations - counters.contactEvaluations;
  frame.awakeBlocks = static_cast<std::size_t>(std::count(simulation.asleep.begin(), simulation.asleep.end(), 0));
  return frame;
}

// A game and a fall are timed whole; a fall fewer times, as it takes as long as many samples of another scene.
ProfileLimits limitsOf(const ProfileCase& what, ProfileLimits limits) {
  constexpr int kFallSamples = 2;
  const bool isGame = what.scene == ProfileScene::game;
  if (!isGame && !isFall(what.scene)) return limits;
  limits.frames = isGame ? static_cast<int>(recordedGame().frames.size()) : fallFamilyOf(what.named).frames;
  if (!isGame) limits.samples = std::min(limits.samples, kFallSamples);
  limits.sample_s = std::numeric_limits<double>::infinity();
  return limits;
}

// How many frames go into one time.
int framesTogether(ProfileScene scene) {
  return scene == ProfileScene::asleep ? kSleepingFrames : 1;
}

// Keeps the least of what a frame took in any sample. The frames of the first sample are all new.
void keepLeast(Measured& measured, std::size_t frame, double wall_ms, double processor_ms, const StageTimes& stages) {
  measured.rawWall_ms.push_back(wall_ms);
  if (measured.result->samples == 0) {
    measured.wall_ms.push_back(wall_ms);
    measured.processor_ms.push_back(processor_ms);
    measured.stages.push_back(stages);
    return;
  }
  if (frame >= measured.wall_ms.size()) return;
  if (wall_ms < measured.wall_ms[frame]) measured.stages[frame] = stages;
  measured.wall_ms[frame] = std::min(measured.wall_ms[frame], wall_ms);
  measured.processor_ms[frame] = std::min(measured.processor_ms[frame], processor_ms);
}

// One sample: the first frame from the kept state is run once without being timed, then again with all the others.
void sample(Measured& measured, const ProfileLimits& limits, Clock::time_point epoch, TracedCase* traced) {
  PreparedScene& scene = *measured.scene;
  Simulation& simulation = scene.simulation;
  const int together = framesTogether(measured.result->what.scene);
  scene.restore();
  scene.step();
  scene.restore();
  measured.before = simulation.counters;
  if (traced != nullptr) traced->frames.clear();
  const Clock::time_point begin = Clock::now();
  std::size_t frames = 0;
  while (frames < static_cast<std::size_t>(limits.frames) &&
         (frames < 2 || secondsBetween(begin, Clock::now()) < limits.sample_s)) {
    endIfInterrupted();
    const StageTimes stages = simulation.stageTimes;
    const Counters counters = simulation.counters;
    const double processorStart_s = processorTime_s();
    const Clock::time_point start = Clock::now();
    for (int i = 0; i < together; ++i) scene.step();
    const double wall_s = secondsBetween(start, Clock::now()) / together;
    const double processor_s = (processorTime_s() - processorStart_s) / together;
    if (traced != nullptr) {
      traced->frames.push_back(tracedFrame(simulation, stages, counters, secondsBetween(epoch, start), wall_s));
    }
    StageTimes spent;
    for (std::size_t i = 0; i < kStages; ++i)
      spent.seconds[i] = (simulation.stageTimes.seconds[i] - stages.seconds[i]) / together;
    keepLeast(measured, frames, 1e3 * wall_s, 1e3 * processor_s, spent);
    measured.substeps += static_cast<std::uint64_t>(simulation.substeps);
    ++frames;
  }
  // All samples have the frames of the shortest one.
  const std::size_t common = std::min(frames, measured.wall_ms.size());
  measured.wall_ms.resize(common);
  measured.processor_ms.resize(common);
  measured.stages.resize(common);
  ++measured.result->samples;
}

// A sample that is not timed: caches and buffers warm up, and accuracy is measured, which would disturb the times.
void warmUp(Measured& measured, const ProfileLimits& limits) {
  PreparedScene& scene = *measured.scene;
  ProfileResult& result = *measured.result;
  const Simulation& simulation = scene.simulation;
  scene.restore();
  const Clock::time_point begin = Clock::now();
  PenetrationWorkspace workspace;
  const ParticleArray start = simulation.state.position;
  const double start_s = simulation.time_s;
  Energy before = energy(simulation);
  const double atStart_j = before.kinetic + std::abs(before.gravity) + before.springs + before.contacts;
  for (int frame = 0; frame < limits.frames && (frame < 2 || secondsBetween(begin, Clock::now()) < limits.sample_s); ++frame) {
    endIfInterrupted();
    scene.step();
    const Penetration deepest =
        maxPenetration(simulation.state.position, simulation.scene.floor, workspace, simulation.model.fixed);
    result.penetration_mm = std::max(result.penetration_mm, 1e3 * deepest.depth);
    if (!isFall(result.what.scene)) continue;
    const Energy after = energy(simulation);
    result.energyRise = std::max(result.energyRise, energyRise(before, after) / atStart_j);
    before = after;
  }
  constexpr double kMinute_s = 60.0;
  if (isStack(result.what.scene)) {
    const double creep_m_s = largestCornerMove(start, simulation.state.position) / (simulation.time_s - start_s);
    result.creepPerMinute_mm = 1e3 * kMinute_s * creep_m_s;
  }
  const MemoryUse use = memoryUse(simulation);
  const auto blocks = static_cast<double>(result.blocks);
  result.stateBytes = static_cast<double>(use.state) / blocks;
  result.contactBytes = static_cast<double>(use.contacts) / blocks;
  result.allBytes = static_cast<double>(use.total()) / blocks;
  const auto each = [](std::size_t bytes, std::size_t pairs) {
    return static_cast<double>(bytes) / std::max(1.0, static_cast<double>(pairs));
  };
  result.pairBytes = each(use.pairs, use.nearPairs);
  result.touchingBytes = each(use.touching, use.touchingPairs);
  result.touchingStepBytes = each(use.touchingSteps, use.touchingPairs);
}

// What is known of a scene as it was prepared; another case may have stepped it since.
void describePrepared(PreparedScene& scene, ProfileResult& result) {
  scene.restore();
  const Simulation fresh(scene.simulation.scene);
  std::vector<int> row;
  for (const BlockSpec& block : scene.simulation.scene.blocks) row.push_back(block.row);
  result.compression_mm = 1e3 * meanRowCompression(scene.simulation.model, fresh.state.position, scene.simulation.state.position,
                                                   bottomRow(scene.simulation.model, fresh.state.position, row));
  result.stiffness_n_m = largestStiffness(scene.simulation.stiffness);
  result.prepared_s = scene.simulation.time_s;
  result.equilibrium_s = scene.equilibrium_s;
}

void finish(Measured& measured) {
  ProfileResult& result = *measured.result;
  const Simulation& simulation = measured.scene->simulation;
  result.frames = static_cast<int>(measured.wall_ms.size());
  result.processor_ms = costOf(measured.processor_ms);
  result.wall_ms = costOf(measured.wall_ms);
  result.rawWall_ms = costOf(measured.rawWall_ms);
  result.frame_ms = result.what.threads == 1 ? measured.processor_ms : measured.wall_ms;
  for (const StageTimes& stages : measured.stages) {
    for (std::size_t i = 0; i < kStages; ++i) result.stage_ms[i] += 1e3 * stages.seconds[i] / static_cast<double>(result.frames);
  }
  // The last sample's, whose frames are those of every sample.
  const double counted = static_cast<double>(std::max<std::uint64_t>(1, simulation.counters.frames - measured.before.frames));
  for (std::size_t i = 0; i < kCounterNames.size(); ++i) {
    const auto member = kCounterNames[i].second;
    result.counted[i] = static_cast<double>(simulation.counters.*member - measured.before.*member) / counted;
  }
  const auto samples = static_cast<double>(measured.rawWall_ms.size());
  result.substeps = static_cast<double>(measured.substeps) / std::max(1.0, samples);
  const Simulation fresh(simulation.scene);
  result.stands =
      standing(simulation.model, fittedBoxes(fresh.state.position), simulation.state.position, measured.scene->leftOut).stands;
}

// Runs one step of the work under the case's number of threads; divergence becomes the case's failure.
template <class Work>
void attempt(ProfileResult& result, const Work& work) {
  if (!result.failure.empty()) return;
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(result.what.threads));
  try {
    work();
  } catch (const DivergenceError& error) {
    result.failure = error.what();
  }
}

}  // namespace

double counted(const ProfileResult& result, std::string_view name) {
  const auto found =
      std::find_if(kCounterNames.begin(), kCounterNames.end(), [&](const auto& entry) { return entry.first == name; });
  return result.counted[static_cast<std::size_t>(found - kCounterNames.begin())];
}

std::vector<ProfileResult> measureProfile(const std::vector<ProfileCase>& cases, const ProfileLimits& limits,
                                          std::chrono::steady_clock::time_point begun, std::vector<TracedCase>* traced,
                                          const ProfileProgress& progress) {
  std::vector<ProfileResult> results(cases.size());
  const std::size_t before = traced != nullptr ? traced->size() : 0;
  if (traced != nullptr) traced->resize(before + cases.size());
  const int all = static_cast<int>(cases.size()) * (2 + limits.samples);
  int done = 0;
  std::vector<std::unique_ptr<PreparedScene>> scenes;
  std::vector<Measured> group(cases.size());
  for (std::size_t i = 0; i < cases.size(); ++i) {
    progress(done++, all, cases[i]);
    ProfileResult& result = results[i];
    result.what = cases[i];
    result.methodName = nameOf(cases[i].method);
    if (i == 0 || !samePreparation(cases[i - 1], cases[i])) {
      const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(cases[i].threads));
      scenes.push_back(prepareScene(cases[i], limits));
    }
    PreparedScene& scene = *scenes.back();
    group[i].scene = &scene;
    group[i].result = &result;
    result.blocks = scene.simulation.scene.blocks.size();
    result.failure = scene.failure;
    if (traced != nullptr) (*traced)[before + i].what = cases[i];
    describePrepared(scene, result);
    progress(done++, all, cases[i]);
    attempt(result, [&] { warmUp(group[i], limitsOf(cases[i], limits)); });
  }
  for (int turn = 0; turn < limits.samples; ++turn) {
    for (Measured& measured : group) {
      const auto at = static_cast<std::size_t>(measured.result - results.data());
      progress(done++, all, measured.result->what);
      const ProfileLimits own = limitsOf(measured.result->what, limits);
      if (turn >= own.samples) continue;
      const bool lastTurn = turn + 1 == own.samples;
      attempt(*measured.result, [&] {
        sample(measured, own, begun, traced != nullptr && lastTurn ? &(*traced)[before + at] : nullptr);
        if (lastTurn) finish(measured);
      });
    }
  }
  for (Measured& measured : group) {
    ProfileResult& result = *measured.result;
    const bool isFirst = &result == results.data() || !samePreparation(result.what, (&result)[-1].what);
    if (!isNamed(result.what.scene) || !isFirst) continue;
    const int frames = isFall(result.what.scene) ? fallFamilyOf(result.what.named).frames : 0;
    result.peers = measurePeer(Peer::bullet, measured.scene->simulation, {frames, result.penetration_mm, limits.peer_s},
                               [&] { progress(done, all, result.what); });
  }
  return results;
}

}  // namespace springtower
