#pragma once

#include "apps/common/peer_process.h"
#include "apps/common/provenance.h"
#include "core/settings.h"

#include <array>
#include <cstddef>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace springtower {

/// What the blocks do while a method's speed and accuracy are measured.
enum class ChartScene {
  uniform,     ///< a tower of equal blocks
  heights,     ///< heights vary by 0.2 mm
  pull,        ///< a block is pulled out of the middle row at 4 cm/s
  drop,        ///< three rows dropped together from 2 cm
  collapse,    ///< the tower leans by a little more than it can stand
  spin,        ///< one block tumbles without gravity
  heavyLight,  ///< every other row ten times as heavy
  wall,        ///< a wall in running bond
  pyramid,     ///< a pyramid of cubes
  shot,        ///< a block flies into the tower at 5 m/s
  heap200,     ///< 200 blocks turned at random fall into a heap
  rain200,     ///< 200 blocks turned at random land within a second
  pile3,       ///< three square rows, shifted, land after 10 cm
  // Not charted: on these the choice of method `auto` is judged, which was made without them.
  holes,  ///< a tower of twelve rows, half of them with blocks missing
  lean,   ///< nine rows, gravity 9 degrees from straight down
  tall,   ///< a tower of 36 rows
  slide,  ///< a block that slides over the floor until friction stops it
  heap,   ///< eight blocks dropped on one another askew
  thrown  ///< two blocks that meet in the air askew and fall to the floor
};

/// Names as the command line spells them, in the order of the enumeration.
inline constexpr std::array<std::string_view, 19> kChartSceneNames = {
    "uniform",  "heights",  "pull",   "drop",  "collapse", "spin", "heavy-light", "wall", "pyramid", "shot",
    "heap-200", "rain-200", "pile-3", "holes", "lean",     "tall", "slide",       "heap", "thrown"};
inline constexpr std::size_t kChartedScenes = 13;
constexpr bool isCharted(ChartScene scene) {
  return static_cast<std::size_t>(scene) < kChartedScenes;
}
constexpr std::string_view nameOf(ChartScene scene) {
  return kChartSceneNames[static_cast<std::size_t>(scene)];
}

/// What is measured of a method's result; a small value is a good one.
enum class ChartMeasure { penetration, compression, strain, creep, jitter, imbalance, energy, error };
inline constexpr std::size_t kChartMeasures = 8;

/// How a measure is named in files, titled on an axis, and below what it makes no difference (drawn there).
struct ChartMeasureRow {
  std::string_view key;
  std::string_view title;
  double floor;
};
inline constexpr std::array<ChartMeasureRow, kChartMeasures> kChartMeasureRows = {
    {{"penetration_mm", "largest penetration, mm", 1e-6},
     {"compression_mm", "tower lower than rigid blocks would be, mm a row", 1e-6},
     {"max_strain", "largest strain of any spring", 1e-9},
     {"creep_mm", "creep, mm", 1e-6},
     {"jitter_mm_s", "root mean square speed of corners at rest, mm/s", 1e-6},
     {"imbalance", "largest force on a block at rest that nothing balances, block weights", 1e-10},
     {"energy_error", "energy gained, or lost where nothing rubs or strikes; of that at the start", 1e-10},
     {"error_mm", "largest distance of a corner from a converged run of the same model, mm", 1e-6}}};

/// The parameter by which a method trades speed for accuracy.
enum class Knob { tolerance, substeps };

/// One point of a chart: a method at one value of its parameter.
struct ChartCase {
  ChartScene scene = ChartScene::uniform;
  Method method = Method::semiImplicitEuler;
  Knob knob = Knob::tolerance;
  double value = 0.0;  ///< m, or steps of a frame
  Peer peer = Peer::none;
  int iterations = 0;  ///< of the solver of contacts, where it has any; 0: its default
  bool operator==(const ChartCase&) const = default;
};

/// How long to look.
struct ChartLimits {
  int rows = 18;          ///< of the towers
  double seconds = 10.0;  ///< s simulated; creep and jitter are those of the second half
  double case_s = 3.0;    ///< s of processor time after which a case has timed out; twice that where blocks move, and four
                          ///< times that where there are hundreds
  int samples = 5;        ///< by turns with those of the other cases, each from the same state
  int frames = 120;       ///< timed in a sample; the first after the state is restored is left out
  double sample_s = 0.2;  ///< s of processor time after which a sample ends early in scenes at rest; see measureChart
  int wallColumns = 40;   ///< blocks in every other course of the wall
  int wallCourses = 25;
  int pyramidRows = 40;  ///< of the pyramid, and cubes in its lowest row
  bool operator==(const ChartLimits&) const = default;
};

/// How a case came out. One that is cut short had come to rest when its time ran out: its figures are those of less time.
enum class ChartOutcome { right, wrongVerdict, diverged, timedOut, cutShort };
inline constexpr std::array<std::string_view, 5> kChartOutcomeNames = {"right", "wrong verdict", "diverged", "timed out",
                                                                       "cut short"};
constexpr std::string_view nameOf(ChartOutcome outcome) {
  return kChartOutcomeNames[static_cast<std::size_t>(outcome)];
}

struct ChartResult {
  ChartCase what;
  ChartOutcome outcome = ChartOutcome::right;
  std::string note;                                            ///< what is worth saying: when it fell or diverged
  double simulated_s = 0.0;                                    ///< how far it came
  double from_s = 0.0;                                         ///< creep and jitter are measured from here
  std::array<double, kChartMeasures> measured{};               ///< NaN where it was not, or means nothing in the scene
  double frame_ms = std::numeric_limits<double>::quiet_NaN();  ///< ms of processor time a frame: mean over the frames, of a fall
                                                               ///< their median, of each the least of the samples
  double worst_ms = std::numeric_limits<double>::quiet_NaN();  ///< the largest of them, of a fall
  int frames = 0;                                              ///< of those that were timed
  int samples = 0;                                             ///< from which the least was taken

  [[nodiscard]] double of(ChartMeasure measure) const { return measured[static_cast<std::size_t>(measure)]; }
};

/// A figure of another engine, measured elsewhere.
struct PeerResult {
  ChartScene scene = ChartScene::uniform;
  std::string engine;
  std::string settings;
  std::string verdict;
  std::array<double, kChartMeasures> measured{};  ///< as above
  double frame_ms = 0.0;
  double worst_ms = std::numeric_limits<double>::quiet_NaN();  ///< as above
  double ratioToBullet = 0.0;  ///< of its time, to Bullet's with 16 steps on the machine it was measured on; NaN unknown, and of
                               ///< all but towers at rest, whose times are drawn as they were measured
};

struct Chart {
  Provenance provenance;
  ChartLimits limits;
  std::vector<ChartResult> results;
  std::vector<PeerResult> peers;
  bool interrupted = false;  ///< by a signal, so that scenes are missing
};

/// "implicit 0.05 mm", "rigid-pgs 64 steps", "bullet 4 steps, 50 iterations".
std::string nameOf(const ChartCase& what);

/// The method without its setting, or the other engine.
inline std::string_view methodOf(const ChartCase& what) {
  return what.peer == Peer::none ? nameOf(what.method) : nameOf(what.peer);
}

/// Whether a scene is a fall that other engines have run too. Its frames differ as much as its blocks move, so that its cost is
/// the median of its frames and the worst of them, and its depth is the largest from the first frame to the last.
constexpr bool isFall(ChartScene scene) {
  return scene == ChartScene::collapse || scene == ChartScene::shot || scene == ChartScene::heap200 ||
         scene == ChartScene::rain200 || scene == ChartScene::pile3;
}

/// Whether blocks move while a scene is timed, so that all methods have to be timed over the same frames of it.
constexpr bool isInMotion(ChartScene scene) {
  return isFall(scene) || scene == ChartScene::pull || scene == ChartScene::drop || scene == ChartScene::spin ||
         scene == ChartScene::slide || scene == ChartScene::heap || scene == ChartScene::thrown;
}

/// Whether a scene is a stack of hundreds of blocks in one island: it is looked at for a shorter time.
constexpr bool isStack(ChartScene scene) {
  return scene == ChartScene::wall || scene == ChartScene::pyramid;
}

/// Whether a scene has hundreds of blocks, so that it is charted with fewer methods, each of which has more time.
constexpr bool hasHundreds(ChartScene scene) {
  return isStack(scene) || scene == ChartScene::heap200 || scene == ChartScene::rain200 || scene == ChartScene::pile3;
}

/// The size of a scene's blocks as in its name: "40x25" of a wall, the number of blocks of a heap, else the number of rows.
std::string sizeText(ChartScene scene, const ChartLimits& limits);

/// Whether a scene is one of the kind that comes to rest, so that it can be held to a tolerance at rest.
constexpr bool comesToRest(ChartScene scene) {
  return !isFall(scene) && scene != ChartScene::pull && scene != ChartScene::spin;
}

/// Whether nothing in a scene rubs or strikes, so that no energy may be lost (but in the first frame, in which a tower's weight
/// comes to its blocks).
constexpr bool keepsEnergy(ChartScene scene) {
  return scene == ChartScene::uniform || scene == ChartScene::heavyLight || scene == ChartScene::spin ||
         scene == ChartScene::tall;
}

}  // namespace springtower
