#include "apps/commands/chart/measure.h"

#include "apps/commands/chart/scene.h"
#include "apps/common/interruption.h"
#include "apps/common/prepare_or_end.h"
#include "core/error.h"
#include "core/processor_time.h"
#include "solver/metrics/balance.h"
#include "solver/metrics/measures.h"
#include "solver/metrics/penetration.h"
#include "solver/runner/run.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <memory>
#include <mutex>
#include <numeric>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>

namespace springtower {
namespace {

// A tower may be looked at from here on, s.
constexpr double kEarliest_s = 1.0;
constexpr double kMotionLimits = 2.0;
constexpr double kHundredsLimits = 4.0;   // for a fifth of the simulated time, and twenty times the blocks
constexpr double kShortSamples_s = 0.03;  // of a case in all, s of processor time, and no more than
constexpr double kShortShare = 0.15;      // this share of what one sample may take
constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

// A frame cannot be broken off. So a tall tower's cost is foreseen from a small one's; no method's grows faster than its cube.
// Returns the seconds that a frame of kFewRows rows takes where one of all rows would take longer than a case may, else 0.
constexpr int kFewRows = 6;
double tooSlowAtFewRows(const ChartCase& what, const ChartLimits& limits) {
  const int rows = towerRows(what.scene, limits);
  if (what.peer != Peer::none || rows <= kFewRows) return 0.0;
  ChartLimits few = limits;
  few.rows = kFewRows;
  ChartCase low = what;
  if (what.scene == ChartScene::tall) low.scene = ChartScene::uniform;  // of other rows
  Simulation simulation(sceneOf(low, few));
  double frame_s = 0.0;
  try {
    prepareOrEnd(simulation);
    stepFrame(simulation);
    const double begin_s = threadTime_s();
    stepFrame(simulation);
    frame_s = threadTime_s() - begin_s;
  } catch (const DivergenceError&) {
    return 0.0;  // the tall tower shows when
  }
  const double ratio = static_cast<double>(rows) / kFewRows;
  return frame_s * ratio * ratio * ratio > limits.case_s ? frame_s : 0.0;
}

// Where the corners are at the end of a smooth scene when its model is stepped so finely that the steps no longer show: springs
// of the case's stiffness, or rigid blocks.
ParticleArray convergedEnd(const ChartCase& what, const ChartLimits& limits) {
  constexpr double kFinerSteps = 8.0;     // of a method of fourth order
  constexpr double kRigidSteps = 5000.0;  // of methods of first order, which chart with up to 200
  ChartCase finest = what;
  finest.peer = Peer::none;
  if (what.knob == Knob::substeps) {
    finest.method = Method::rigidPgs;
    finest.value = kRigidSteps;
  } else {
    finest.method = Method::rungeKutta4;
  }
  Scene scene = sceneOf(finest, limits);
  if (what.knob == Knob::tolerance) scene.settings.stabilitySafety /= kFinerSteps;
  Simulation simulation(scene);
  prepareOrEnd(simulation);
  const double end_s = timesOf(what.scene, limits).end_s - 0.5 * scene.settings.frame_s;
  while (simulation.time_s < end_s) {
    endIfInterrupted();
    stepFrame(simulation);
  }
  return simulation.state.position;
}

// What the last frame has made of each block's momentum, in weights of the block: for an engine whose contact forces are not
// known.
double imbalanceFromMomentum(const Simulation& simulation, const ParticleArray& velocityBefore) {
  double largest = 0.0;
  for (std::size_t b = 0; b < simulation.model.blockCount(); ++b)
    largest = std::max(largest, (centre(simulation.state.velocity, b) - centre(velocityBefore, b)).norm());
  return largest / (simulation.scene.settings.frame_s * simulation.scene.gravity.magnitude);
}

// A case on its way: its simulation, its accuracy so far, and its times.
class ChartRun {
 public:
  ChartRun(const ChartCase& what, const ChartLimits& limits)
      : limits_(limits), times_(timesOf(what.scene, limits)), simulation_(sceneOf(what, limits)) {
    result.what = what;
    result.measured.fill(kNone);
    const Scene& scene = simulation_.scene;
    start_ = simulation_.state.position;
    for (const BlockSpec& block : scene.blocks) row_.push_back(block.row);
    closed_ = stackedReference(start_, row_, scene.floor);
    reference_ = fittedBoxes(closed_);
    if (what.method == Method::automatic) result.note = fmt::format("took {}", nameOf(scene.settings.method));
    if (what.peer != Peer::none)
      peer_ = std::make_unique<PeerProcess>(what.peer, PeerSettings{static_cast<int>(what.value), what.iterations}, scene);
    pulled_ = pulledBlock(what.scene, scene);
    if (pulled_ >= 0) {
      leftOut_.assign(scene.blocks.size(), 0);
      leftOut_[static_cast<std::size_t>(pulled_)] = 1;
    }
  }

  void measureAccuracy() {
    if (const double few_s = tooSlowAtFewRows(result.what, limits_); few_s > 0.0) {
      result.outcome = ChartOutcome::timedOut;
      result.note = fmt::format("timed out, foreseen: a frame of {} rows takes {:.2g} s", kFewRows, few_s);
      return;
    }
    start_j_ = energy(simulation_).total();
    double reference_j = start_j_;
    double wrong_j = 0.0;
    try {
      while (simulation_.time_s < times_.end_s - halfFrame()) {
        endIfInterrupted();
        if (!kept_ && simulation_.time_s > times_.keep_s - halfFrame()) keep();
        const double step_s = timedStep();
        spent_s_ += step_s;
        ++steps_;
        if (kept_ && isInMotion(result.what.scene)) keepInMotion(step_s);
        observe();
        const double now_j = energy(simulation_).total();
        wrong_j = std::max(wrong_j, now_j - reference_j);
        if (!keepsEnergy(result.what.scene) || (steps_ == 1 && comesToRest(result.what.scene))) {
          reference_j = std::min(reference_j, now_j);  // a tower's weight comes to its blocks in the first frame
        } else {
          wrong_j = std::max(wrong_j, reference_j - now_j);
        }
        if (spent_s_ > caseLimit_s() && !lookAtOnce()) break;
      }
      finish(wrong_j);
    } catch (const DivergenceError& error) {
      result.outcome = ChartOutcome::diverged;
      result.note = fmt::format("diverged at {:.3g} s", error.time_s);
    }
    result.simulated_s = simulation_.time_s;
    takeTimes();
    // Until a sample says so better.
    if (frame_ms_.empty() && steps_ > 0) result.frame_ms = 1e3 * spent_s_ / steps_;
  }

  // One sample: back to the kept state, a frame that is not timed, then the timed ones.
  void sample() {
    const double enough_s = limits_.samples * limits_.sample_s;
    if (!mayBeSampled() || sampling_s_ > enough_s) return;
    restoreSnapshot(simulation_, *snapshot_);
    hand_ = handKept_;
    const bool inMotion = isInMotion(result.what.scene);
    const std::size_t frames = inMotion ? frame_ms_.size() : static_cast<std::size_t>(limits_.frames);
    double spent_s = 0.0;
    std::size_t frame = 0;
    try {
      if (peer_) peer_->restore();
      spent_s = timedStep();
      while (frame < frames && (inMotion || spent_s < limits_.sample_s || frame < 1)) {
        endIfInterrupted();
        const double step_s = timedStep();
        spent_s += step_s;
        keepLeast(frame++, step_s);
      }
    } catch (const DivergenceError& error) {
      result.note = fmt::format("diverged at {:.3g} s while it was timed", error.time_s);
    }
    sampling_s_ += spent_s;
    frame_ms_.resize(std::min(frame_ms_.size(), frame));
    ++result.samples;
    takeTimes();
  }

  // Whether its samples are so short that more of them cost nothing: a processor whose speed jumps needs them.
  [[nodiscard]] bool isShort() const {
    return mayBeSampled() && !frame_ms_.empty() && sampling_s_ < std::min(kShortSamples_s, kShortShare * limits_.sample_s);
  }

  ChartResult result;

 private:
  [[nodiscard]] bool mayBeSampled() const { return result.outcome != ChartOutcome::diverged && kept_ && !timedEnough_; }
  [[nodiscard]] double halfFrame() const { return 0.5 * simulation_.scene.settings.frame_s; }

  // What is in motion is not timed beside, and has to be seen to its end.
  [[nodiscard]] double caseLimit_s() const {
    const ChartScene scene = result.what.scene;
    return (hasHundreds(scene) ? kHundredsLimits : isInMotion(scene) ? kMotionLimits : 1.0) * limits_.case_s;
  }

  // A slow method that comes to rest is looked at before its time, so that it has figures at all. Returns whether the run may go
  // on: for a quarter of its limit more.
  bool lookAtOnce() {
    const bool settled = simulation_.time_s > times_.from_s - halfFrame();
    if (!settled && comesToRest(result.what.scene) && simulation_.time_s > kEarliest_s) {
      times_.from_s = simulation_.time_s;
      more_s_ = 0.25 * caseLimit_s();
    }
    return spent_s_ <= caseLimit_s() + more_s_;
  }

  void keep() {
    kept_ = true;
    if (peer_) peer_->keep();
    snapshot_ = takeSnapshot(simulation_);
    if (pulled_ < 0) return;
    hand_.block = pulled_;
    hand_.direction = meanEdge(simulation_.state.position, static_cast<std::size_t>(pulled_), 0).normalized();
    handKept_ = hand_;
  }

  // One frame; returns the processor time of its step, s.
  double timedStep() {
    if (peer_) {
      if (hand_.block >= 0) {
        pull(hand_, simulation_);
        peer_->push(simulation_.scene.forces.front());
      }
      velocityBefore_ = simulation_.state.velocity;
      const double step_s = peer_->step(simulation_.state);
      simulation_.time_s = static_cast<double>(++simulation_.frame) * simulation_.scene.settings.frame_s;
      return step_s;
    }
    prepareOrEnd(simulation_);
    const double begin_s = threadTime_s();
    if (hand_.block >= 0) pull(hand_, simulation_);
    stepFrame(simulation_);
    return threadTime_s() - begin_s;
  }

  void keepLeast(std::size_t frame, double step_s) {
    if (frame < frame_ms_.size()) {
      frame_ms_[frame] = std::min(frame_ms_[frame], 1e3 * step_s);
    } else if (result.samples == 0) {
      frame_ms_.push_back(1e3 * step_s);
    }
  }

  // Where blocks move, what one method is timed over all are. So the run that is looked at is a sample too, and of those that are
  // slow the only one.
  void keepInMotion(double step_s) {
    if (keptFrames_++ == 0 || frame_ms_.size() == static_cast<std::size_t>(limits_.frames)) return;
    frame_ms_.push_back(1e3 * step_s);
    if (1e-3 * std::accumulate(frame_ms_.begin(), frame_ms_.end(), 0.0) > limits_.sample_s) timedEnough_ = true;
    result.samples = 1;
  }

  void takeTimes() {
    result.frames = static_cast<int>(frame_ms_.size());
    if (result.frames == 0) return;
    if (isFall(result.what.scene)) {
      result.frame_ms = quantile(frame_ms_, 0.5);
      result.worst_ms = quantile(frame_ms_, 1.0);
    } else {
      result.frame_ms = std::accumulate(frame_ms_.begin(), frame_ms_.end(), 0.0) / result.frames;
    }
  }

  // What is looked at after every frame.
  void observe() {
    const ParticleArray& position = simulation_.state.position;
    const ChartScene scene = result.what.scene;
    if (fall_.empty() && expectedToStand(scene)) {
      const Standing now = standing(simulation_.model, reference_, position, leftOut_);
      if (!now.stands) fall_ = fmt::format("fell at {:.2f} s", simulation_.time_s);
    }
    const bool settled = simulation_.time_s > times_.from_s + halfFrame();
    const bool wholeRun = scene == ChartScene::drop || isFall(scene);
    if (wholeRun || settled) {
      strain_ = std::max(strain_, maxStrain(simulation_.model, position));
      penetration_m_ =
          std::max(penetration_m_, maxPenetration(position, simulation_.scene.floor, workspace_, simulation_.model.fixed).depth);
    }
    if (!settled) return;
    if (settledPosition_.blockCount() == 0) {
      settledPosition_ = position;
      result.from_s = simulation_.time_s;
    }
    creep_m_ = std::max(creep_m_, largestCornerMove(settledPosition_, position));
    const double speed = rootMeanSquareCornerSpeed(simulation_.state.velocity);
    squares_ += speed * speed;
    ++counted_;
  }

  void finish(double wrong_j) {
    const ChartScene scene = result.what.scene;
    if (!kept_) keep();
    const bool complete = simulation_.time_s > times_.end_s - halfFrame();
    const std::optional<bool> expected = expectedToStand(scene);
    if (!fall_.empty()) result.note = fall_;
    if (expected && fall_.empty() != *expected && (complete || *expected)) {
      result.outcome = ChartOutcome::wrongVerdict;
      if (fall_.empty()) result.note = "stands";
    } else if (!complete) {
      const bool cut = counted_ > 0 && comesToRest(scene);
      result.outcome = cut ? ChartOutcome::cutShort : ChartOutcome::timedOut;
      result.note =
          fmt::format("{}{}{} at {:.2f} s", fall_, fall_.empty() ? "" : ", ", nameOf(result.outcome), simulation_.time_s);
    }
    const auto set = [&](ChartMeasure measure, double value) { result.measured[static_cast<std::size_t>(measure)] = value; };
    if (start_j_ != 0.0) set(ChartMeasure::energy, wrong_j / std::abs(start_j_));
    if (scene == ChartScene::spin) {
      if (complete)
        set(ChartMeasure::error, 1e3 * largestCornerMove(convergedEnd(result.what, limits_), simulation_.state.position));
      return;
    }
    if (penetration_m_ >= 0.0) set(ChartMeasure::penetration, 1e3 * penetration_m_);
    if (strain_ >= 0.0 && !peer_ && !isRigid(simulation_.scene.settings.method)) set(ChartMeasure::strain, strain_);
    if (!comesToRest(scene) || counted_ == 0) return;
    const int rows = 1 + *std::max_element(row_.begin(), row_.end());
    if (rows > 0) set(ChartMeasure::compression, 1e3 * std::abs(topHeightError(closed_, simulation_.state.position)) / rows);
    set(ChartMeasure::creep, 1e3 * creep_m_);
    set(ChartMeasure::imbalance, peer_ ? imbalanceFromMomentum(simulation_, velocityBefore_)
                                       : largestImbalance(imbalances(simulation_, contactForces(simulation_))).force);
    set(ChartMeasure::jitter, 1e3 * std::sqrt(squares_ / counted_));
  }

  ChartLimits limits_;
  ChartTimes times_;
  Simulation simulation_;
  ParticleArray start_;
  ParticleArray closed_;  // the start without gaps between rows
  std::vector<FittedBox> reference_;
  std::vector<int> row_;
  std::vector<std::uint8_t> leftOut_;
  int pulled_ = -1;
  SteadyPull hand_;
  SteadyPull handKept_;
  std::unique_ptr<PeerProcess> peer_;  // instead of our own steps
  ParticleArray velocityBefore_;       // of its last frame
  bool kept_ = false;
  std::shared_ptr<const Snapshot> snapshot_;
  PenetrationWorkspace workspace_;
  ParticleArray settledPosition_;
  std::string fall_;
  double start_j_ = 0.0;
  double penetration_m_ = -1.0;
  double strain_ = -1.0;
  double creep_m_ = 0.0;
  double squares_ = 0.0;
  double counted_ = 0.0;
  double spent_s_ = 0.0;
  double more_s_ = 0.0;  // beyond the limit
  int steps_ = 0;
  int keptFrames_ = 0;  // since the state was kept
  bool timedEnough_ = false;
  double sampling_s_ = 0.0;
  std::vector<double> frame_ms_;  // of each frame the least of the samples
};

}  // namespace

std::vector<ChartResult> measureChart(const std::vector<ChartCase>& cases, const ChartLimits& limits,
                                      const ChartProgress& progress) {
  std::vector<std::unique_ptr<ChartRun>> runs(cases.size());
  std::mutex mutex;
  // Each in an arena of its own, so that no thread takes up a second case in the middle of one it is timing.
  tbb::parallel_for(std::size_t{0}, cases.size(), [&](std::size_t i) {
    tbb::task_arena alone(1);
    alone.execute([&] {
      runs[i] = std::make_unique<ChartRun>(cases[i], limits);
      runs[i]->measureAccuracy();
    });
    const std::scoped_lock lock(mutex);
    progress(cases[i]);
  });
  tbb::task_arena alone(1);
  for (int turn = 0; turn < limits.samples; ++turn) {
    for (const auto& run : runs) {
      alone.execute([&] { run->sample(); });
      progress(run->result.what);
    }
  }
  for (bool more = true; more;) {
    more = false;
    for (const auto& run : runs) {
      if (!run->isShort()) continue;
      alone.execute([&] { run->sample(); });
      more = true;
    }
  }
  std::vector<ChartResult> results;
  results.reserve(runs.size());
  for (const auto& run : runs) results.push_back(std::move(run->result));
  return results;
}

}  // namespace springtower
