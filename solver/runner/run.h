#pragma once

#include "solver/frame/prepare.h"
#include "solver/hand/moves.h"
#include "solver/metrics/balance.h"
#include "solver/metrics/measures.h"
#include "solver/metrics/penetration.h"
#include "solver/runner/run_state.h"
#include "solver/world/simulation.h"

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

namespace springtower {

/// Start time of the measurement of penetration and creep where a scene does not come to rest, s.
inline constexpr double kSettledTime_s = 5.0;

/// Options of a run. `run`, `verdict`, charts and tests use the same driver.
struct RunOptions {
  double seconds = 10.0;          ///< s; rounded to whole frames, at least one
  bool stopWhenFallen = false;    ///< end with the frame in which the scene has fallen
  bool stopWhenAtRest = false;    ///< end when all blocks are at rest
  double secondsAfterRest = 0.0;  ///< s; with stopWhenAtRest, time simulated beyond rest, to detect late falls and creep
  bool measureEveryFrame =
      true;  ///< penetration, strain, creep, jitter and energy in every frame; otherwise at the start and at the end only
  std::vector<std::uint8_t> leftOut;  ///< 1 for blocks that do not count for `stands`, [blocks] or empty
  PrepareOptions prepare;             ///< of the search for the equilibrium before the first frame; its `goesOn` may be empty
  /// Called after every frame and, on any thread, during that search: true ends the run with it, as `interrupted`; or empty.
  std::function<bool()> shouldStop;
  /// A run that was saved, to go on with: `seconds` are then those beyond it, and penetration, rest, energy and times are
  /// measured from there on. Null: the run begins. Precondition: the simulation is made of its scene, and has not been prepared.
  const SavedRun* resumed = nullptr;
};

/// Times of the frames, ms: stepFrame only, without measures and output. CPU time is that of the whole process, over all threads;
/// quote it on a busy machine.
struct FrameTimes {
  double median = 0.0;
  double p99 = 0.0;
  double max = 0.0;
  double cpuMedian = 0.0;
};

/// Result of a run. Measures for which the run was too short are empty.
struct RunResult {
  Standing standing;                       ///< the first fall, or that the scene stands
  std::optional<double> fallTime_s;        ///< first frame in which it had fallen
  std::optional<double> restTime_s;        ///< first frame in which all blocks were at rest (`atRest`)
  bool interrupted = false;                ///< ended by `shouldStop` with frames left to do
  std::uint64_t frames = 0;                ///< of this run
  PrepareResult prepared;                  ///< zeros where the simulation was prepared before
  std::optional<double> resumedAt_s;       ///< simulated time at which it went on with a run that was saved
  int substeps = 0;                        ///< steps of the last frame in which a block was awake
  double simulated_s = 0.0;                ///< simulated time of this run
  double wall_s = 0.0;                     ///< whole run, measures and callback included
  FrameTimes frameTimes;                   ///< ms
  std::array<double, kStages> stage_ms{};  ///< mean over the frames of this run
  Counters counters;                       ///< of the simulation, since it was made
  WakeCounts wakes{};                      ///< blocks woken since then, by reason
  std::optional<double> maxPenetration_m;  ///< largest from restTime_s on, or from 5 s on without rest
  Penetration deepest;                     ///< largest of the whole run, its start included
  double deepestTime_s = 0.0;              ///< time of the latter
  double bottomRowCompression_m = 0.0;     ///< at the end
  double maxStrain = 0.0;                  ///< largest of the whole run
  std::optional<double> creep_m;           ///< largest move of a corner from restTime_s on, or from 5 s on
  double jitter_m_s = 0.0;                 ///< root mean square over all corners and the last second
  double topHeightError_m = 0.0;           ///< at the end, relative to rigid blocks without gaps
  Energy energyStart;
  Energy energyEnd;
  /// Largest rise of the total energy in a frame, over the most energy that there was in the run, what forces, hand and drives
  /// have put in included: kinetic, of springs and contacts, and the magnitude of the potential. Empty where there was none.
  std::optional<double> maxEnergyRise;
  Imbalance imbalance;            ///< largest at the end
  double outsideCone_n = 0.0;     ///< N, of the worst contact point at the end
  std::size_t asleepBlocks = 0;   ///< at the end, without fixed ones
  std::size_t awakeBlocks = 0;    ///< at the end
  std::uint64_t stateHash = 0;    ///< at the end
  std::vector<MoveResult> moves;  ///< of the scene's moves that have ended
  RunProgress progress;           ///< what another run needs to go on with, beside the scene and a snapshot
};

/// Called once before the scene is prepared and after every frame.
using FrameCallback = std::function<void(const Simulation&)>;

/// Prepares a scene (solver/frame/prepare.h), runs it for a time and measures it. Rest, fall and penetration are measured
/// relative to the state at the call; times are simulated times. A frame in which every block sleeps is not measured again,
/// because nothing has changed. While all blocks are at rest the energy is not measured in every frame, as that would cost more
/// than the frame; a rise over such a period counts as one. A scene with moves is run until the last of them has ended or it has
/// fallen; blocks in the hand and those put aside are left out of `standing`, blocks in a new place are compared with that place,
/// and creep is not measured. A run that goes on (`options.resumed`) is bit for bit what one run would have been that did
/// not stop. Throws InputError where what was saved does not fit the simulation, and DivergenceError from the frame that
/// diverges; the simulation is then left as that frame left it.
RunResult runScene(Simulation& simulation, const RunOptions& options, const FrameCallback& afterFrame = {});

/// The q-quantile (0 < q <= 1) of some values by nearest rank: the least value that at least a share q of them does not exceed. 0
/// for none.
double quantile(std::vector<double> values, double q);

}  // namespace springtower
