#include "solver/runner/run.h"

#include "core/processor_time.h"

#include <algorithm>
#include <chrono>
#include <cmath>

namespace springtower {
namespace {

using Clock = std::chrono::steady_clock;

double secondsSince(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

// How much energy there is, J. The total is no measure of that: it is relative to the floor, so that what falls from there or
// hangs below it may have any total, and zero in all of its motion.
double magnitudeOf(const Energy& energy) {
  return energy.kinetic + std::abs(energy.gravity) + energy.springs + energy.contacts;
}

// Measures of one frame.
struct FrameMeasures {
  Penetration penetration;
  double meanSquareSpeed = 0.0;
  Energy energy;  // when last measured
};

// Everything about a run that accumulates from frame to frame.
class Recorder {
 public:
  // `start`: positions at the start of the scene, m.
  Recorder(const Simulation& simulation, const ParticleArray& start, const RunOptions& options)
      : options_(options), startTime_s_(simulation.time_s), startPosition_(start), startStages_(simulation.stageTimes) {
    for (const BlockSpec& block : simulation.scene.blocks) row_.push_back(block.row);
    closed_ = stackedReference(startPosition_, row_, simulation.scene.floor);
    if (options.resumed != nullptr) {
      const RunProgress& before = options.resumed->progress;
      reference_ = before.reference;
      laid_ = before.laid;
      result_.standing = before.standing;
      result_.fallTime_s = before.fallTime_s;
    } else {
      reference_ = fittedBoxes(closed_);
    }
    const long framesInASecond = std::lround(1.0 / simulation.scene.settings.frame_s);
    lastSecond_.assign(static_cast<std::size_t>(std::max(1L, framesInASecond)), 0.0);
    measure(simulation);
    startPenetration_m_ = now_.penetration.depth;
    result_.energyStart = energy(simulation);
    now_.energy = result_.energyStart;
    mostEnergy_j_ = magnitudeOf(now_.energy);
  }

  // After the search for the equilibrium. What starts with the overlaps or the strain of a rest state has no contacts yet when it
  // is placed, and gets the energy of its springs here: frames begin with that.
  void prepared(const Simulation& simulation) {
    const auto isStrained = [](const BlockSpec& block) { return block.strain != nullptr; };
    const std::vector<BlockSpec>& blocks = simulation.scene.blocks;
    const bool overlaps = startPenetration_m_ > simulation.lengths.contactError_m;
    if (overlaps || std::any_of(blocks.begin(), blocks.end(), isStrained)) now_.energy = energy(simulation);
  }

  // `unchanged`: nothing moved in this frame, so the measures of the frame before still hold.
  void frame(const Simulation& simulation, const MoveRun& moves, bool unchanged, double wall_s, double processor_s) {
    wall_ms_.push_back(1e3 * wall_s);
    processor_ms_.push_back(1e3 * processor_s);
    if (!unchanged && !result_.fallTime_s) judge(simulation, moves);
    if (simulation.substeps > 0) result_.substeps = simulation.substeps;
    const bool resting = atRest(simulation);
    const bool firstRest = resting && !result_.restTime_s;
    if (firstRest) result_.restTime_s = simulation.time_s;
    const double ran_s = simulation.time_s - startTime_s_ + 0.5 * simulation.scene.settings.frame_s;
    if (firstRest || (!settled_ && ran_s > kSettledTime_s)) settle(simulation);
    if (!unchanged && options_.measureEveryFrame) {
      measure(simulation);
      measureEnergy(energy(simulation));
    }
    if (settled_) settledPenetration_m_ = std::max(settledPenetration_m_, now_.penetration.depth);
    lastSecond_[(wall_ms_.size() - 1) % lastSecond_.size()] = now_.meanSquareSpeed;
  }

  [[nodiscard]] const RunResult& soFar() const { return result_; }

  RunResult finish(const Simulation& simulation) {
    if (!options_.measureEveryFrame) measure(simulation);
    result_.frames = wall_ms_.size();
    result_.simulated_s = simulation.time_s - startTime_s_;
    result_.counters = simulation.counters;
    result_.wakes = simulation.wakes;
    timeFrames(simulation);
    if (settled_) {
      result_.maxPenetration_m = std::max(settledPenetration_m_, now_.penetration.depth);
      if (simulation.scene.moves.empty()) result_.creep_m = creep_m_;
    }
    result_.bottomRowCompression_m = meanRowCompression(simulation.model, startPosition_, simulation.state.position,
                                                        bottomRow(simulation.model, startPosition_, row_));
    result_.jitter_m_s = options_.measureEveryFrame ? jitter() : std::sqrt(now_.meanSquareSpeed);
    result_.topHeightError_m = topHeightError(closed_, simulation.state.position);
    result_.energyEnd = energy(simulation);
    measureEnergy(result_.energyEnd);
    if (options_.measureEveryFrame && mostEnergy_j_ > 0.0) result_.maxEnergyRise = largestRise_j_ / mostEnergy_j_;
    const std::vector<ContactForce> contacts = contactForces(simulation);
    result_.imbalance = largestImbalance(imbalances(simulation, contacts));
    result_.outsideCone_n = farthestOutsideCone(simulation, contacts);
    const auto sleeping = std::count(simulation.asleep.begin(), simulation.asleep.end(), 1);
    const auto fixed = std::count(simulation.model.fixed.begin(), simulation.model.fixed.end(), 1);
    result_.asleepBlocks = static_cast<std::size_t>(sleeping - fixed);
    result_.awakeBlocks = simulation.asleep.size() - static_cast<std::size_t>(sleeping);
    result_.stateHash = stateHash(simulation);
    result_.progress.reference = reference_;
    result_.progress.laid = laid_;
    result_.progress.standing = result_.standing;
    result_.progress.fallTime_s = result_.fallTime_s;
    return std::move(result_);
  }

 private:
  void judge(const Simulation& simulation, const MoveRun& moves) {
    for (; laid_ < moves.laid.size(); ++laid_) {
      reference_[moves.laid[laid_]] = fittedBox(simulation.state.position, moves.laid[laid_]);
    }
    const std::vector<std::uint8_t>& leftOut = simulation.scene.moves.empty() ? options_.leftOut : moves.leftOut;
    const Standing now = standing(simulation.model, reference_, simulation.state.position, leftOut);
    if (now.stands) return;
    result_.standing = now;
    result_.fallTime_s = simulation.time_s;
  }

  void measure(const Simulation& simulation) {
    const MotionState& state = simulation.state;
    now_.penetration = maxPenetration(state.position, simulation.scene.floor, workspace_, simulation.model.fixed);
    if (now_.penetration.depth > result_.deepest.depth) {
      result_.deepest = now_.penetration;
      result_.deepestTime_s = simulation.time_s;
    }
    result_.maxStrain = std::max(result_.maxStrain, maxStrain(simulation.model, state.position));
    if (settled_) creep_m_ = std::max(creep_m_, largestCornerMove(settledPosition_, state.position));
    const double speed = rootMeanSquareCornerSpeed(state.velocity);
    now_.meanSquareSpeed = speed * speed;
  }

  void measureEnergy(Energy energy) {
    largestRise_j_ = std::max(largestRise_j_, energyRise(now_.energy, energy));
    mostEnergy_j_ = std::max(mostEnergy_j_, magnitudeOf(energy));
    now_.energy = std::move(energy);
  }

  // From here on penetration and creep are those of a settled scene. Rest that comes after kSettledTime_s restarts them.
  void settle(const Simulation& simulation) {
    settled_ = true;
    settledPosition_ = simulation.state.position;
    settledPenetration_m_ = 0.0;
    creep_m_ = 0.0;
  }

  [[nodiscard]] double jitter() const {
    const std::size_t frames = std::min(lastSecond_.size(), wall_ms_.size());
    double sum = 0.0;
    for (std::size_t i = 0; i < frames; ++i) sum += lastSecond_[i];
    return frames == 0 ? 0.0 : std::sqrt(sum / static_cast<double>(frames));
  }

  void timeFrames(const Simulation& simulation) {
    result_.frameTimes = {quantile(wall_ms_, 0.5), quantile(wall_ms_, 0.99), quantile(wall_ms_, 1.0),
                          quantile(processor_ms_, 0.5)};
    const double frames = static_cast<double>(std::max<std::size_t>(1, wall_ms_.size()));
    for (std::size_t i = 0; i < kStages; ++i) {
      result_.stage_ms[i] = 1e3 * (simulation.stageTimes.seconds[i] - startStages_.seconds[i]) / frames;
    }
  }

  RunOptions options_;
  RunResult result_;
  double startTime_s_;
  ParticleArray startPosition_;
  StageTimes startStages_;
  std::vector<int> row_;              // of each block, or -1
  ParticleArray closed_;              // the start without gaps between rows
  std::vector<FittedBox> reference_;  // of closed_
  std::size_t laid_ = 0;              // blocks whose new place is included
  PenetrationWorkspace workspace_;
  FrameMeasures now_;
  double startPenetration_m_ = 0.0;
  double largestRise_j_ = 0.0;
  double mostEnergy_j_ = 0.0;  // that was there, or put in, so far
  bool settled_ = false;
  ParticleArray settledPosition_;
  double settledPenetration_m_ = 0.0;
  double creep_m_ = 0.0;
  std::vector<double> lastSecond_;  // mean square speeds of the last frames, a ring buffer
  std::vector<double> wall_ms_;
  std::vector<double> processor_ms_;
};

// Prepares the simulation; `shouldStop` ends that as well.
PrepareResult prepareFor(Simulation& simulation, const RunOptions& options) {
  PrepareOptions how = options.prepare;
  how.goesOn = [&](const PrepareProgress& progress) {
    const bool goesOn = !options.prepare.goesOn || options.prepare.goesOn(progress);
    return goesOn && !(options.shouldStop && options.shouldStop());
  };
  return prepare(simulation, how);
}

// Brings a simulation that has just been made to where a run was saved.
void resume(Simulation& simulation, const SavedRun& saved) {
  checkFits(*saved.snapshot, simulation, "saved run");
  restoreSnapshot(simulation, *saved.snapshot);
}

}  // namespace

RunResult runScene(Simulation& simulation, const RunOptions& options, const FrameCallback& afterFrame) {
  const Clock::time_point start = Clock::now();
  const ParticleArray placed = simulation.state.position;
  if (options.resumed != nullptr) resume(simulation, *options.resumed);
  Recorder recorder(simulation, placed, options);
  MoveRun moves = options.resumed != nullptr ? options.resumed->progress.moves : beginMoves(simulation);
  if (afterFrame) afterFrame(simulation);
  const long frames = std::max(1L, std::lround(options.seconds / simulation.scene.settings.frame_s));
  const PrepareResult prepared = prepareFor(simulation, options);
  recorder.prepared(simulation);
  bool interrupted = prepared.end == PrepareEnd::cancelled;
  for (long frame = 0; frame < frames && !interrupted; ++frame) {
    if (!simulation.scene.moves.empty()) {
      guideHand(moves, simulation);
      if (moves.finished || recorder.soFar().fallTime_s) break;
    }
    const bool slept = allAsleep(simulation);
    const double processorStart_s = processorTime_s();
    const Clock::time_point frameStart = Clock::now();
    stepFrame(simulation);
    const double wall_s = secondsSince(frameStart);
    const double processor_s = processorTime_s() - processorStart_s;
    recorder.frame(simulation, moves, slept && allAsleep(simulation), wall_s, processor_s);
    if (afterFrame) afterFrame(simulation);
    const RunResult& soFar = recorder.soFar();
    if (options.stopWhenFallen && soFar.fallTime_s) break;
    const double halfFrame_s = 0.5 * simulation.scene.settings.frame_s;  // times are sums of frames, with rounding
    if (options.stopWhenAtRest && soFar.restTime_s &&
        simulation.time_s > *soFar.restTime_s + options.secondsAfterRest - halfFrame_s) {
      break;
    }
    interrupted = frame + 1 < frames && options.shouldStop && options.shouldStop();
  }
  RunResult result = recorder.finish(simulation);
  result.interrupted = interrupted;
  result.prepared = prepared;
  if (options.resumed != nullptr) result.resumedAt_s = options.resumed->snapshot->time_s;
  result.moves = moves.results;
  result.progress.moves = std::move(moves);
  result.wall_s = secondsSince(start);
  return result;
}

double quantile(std::vector<double> values, double q) {
  if (values.empty()) return 0.0;
  const double rank = std::ceil(q * static_cast<double>(values.size()));
  const std::size_t last = values.size() - 1;
  const std::size_t i = std::min(last, static_cast<std::size_t>(std::max(1.0, rank)) - 1);
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(i), values.end());
  return values[i];
}

}  // namespace springtower
