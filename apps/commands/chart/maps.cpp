#include "apps/commands/chart/maps.h"

#include "apps/common/interruption.h"
#include "apps/common/prepare_or_end.h"
#include "core/error.h"
#include "core/processor_time.h"
#include "core/scene/scene.h"
#include "solver/metrics/measures.h"
#include "solver/metrics/penetration.h"
#include "solver/world/engine.h"
#include "solver/world/simulation.h"

#include <algorithm>
#include <cmath>
#include <mutex>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>

namespace springtower {
namespace {

// The nudge: from it an unstable step grows, and a stable one stays below what counts as jitter.
constexpr double kNudge_m_s = 5e-4;
constexpr double kJitter_m_s = 1e-3;  // root mean square speed of all corners
constexpr int kBisections = 5;

constexpr std::array kMapped = {Method::semiImplicitEuler, Method::midpoint,      Method::rungeKutta4,
                                Method::implicit,          Method::implicitEuler, Method::report,
                                Method::rigidPgs,          Method::rigidLcp,      Method::xpbd};

// Dashpots off, so that the step meets springs alone, as theory has it.
Scene sceneOf(Method method, int rows, double tolerance_m, int steps) {
  Scene scene = towerScene(rows);
  scene.settings.method = method;
  scene.settings.sleep = Sleep::off;
  scene.settings.tolerance_m = tolerance_m;
  scene.settings.substeps = steps;
  scene.settings.allowUnstable = true;
  scene.settings.stiffnessDamping = 0.0;
  return scene;
}

double largestOmega(const Simulation& simulation) {
  double squared = 0.0;
  for (const StepBound& bound : simulation.engine->memo.stepBound) squared = std::max(squared, bound.spectralRadius);
  return std::sqrt(squared);
}

// What a second half of a run showed.
struct Seen {
  double speed_m_s = 0.0;
  double move_m = 0.0;
  double penetration_m = 0.0;
  double sag_m = 0.0;  // of a row
};

MapVerdict verdictOf(const Seen& seen, double seconds) {
  if (seen.speed_m_s > kJitter_m_s) return MapVerdict::jitters;
  if (seen.move_m > kMapTolerance_m * seconds) return MapVerdict::creeps;
  if (seen.penetration_m > kMapTolerance_m || seen.sag_m > kMapTolerance_m) return MapVerdict::sags;
  return MapVerdict::stands;
}

MapPoint tried(Method method, int rows, double tolerance_m, int steps, const MapLimits& limits) {
  const double begin_s = threadTime_s();
  Simulation simulation(sceneOf(method, rows, tolerance_m, steps));
  const double frame_s = simulation.scene.settings.frame_s;
  MapPoint point;
  point.steps = steps;
  point.step_s = frame_s / steps;
  point.rows = rows;
  if (!isRigid(method)) point.stiffness = largestStiffness(simulation.stiffness);
  const std::vector<FittedBox> start = fittedBoxes(simulation.state.position);
  std::vector<int> row;
  for (const BlockSpec& block : simulation.scene.blocks) row.push_back(block.row);
  const ParticleArray closed = stackedReference(simulation.state.position, row, true);
  const long frames = std::max(4L, std::lround(limits.seconds / frame_s));
  const long half = frames / 2;
  ParticleArray settled;
  double squares = 0.0;
  try {
    prepareOrEnd(simulation);
    for (long frame = 0; frame < frames; ++frame) {
      endIfInterrupted();
      stepFrame(simulation);
      point.omega = std::max(point.omega, largestOmega(simulation));
      if (frame == 0) kick(simulation, simulation.model.blockCount() - 1, Vec3(kNudge_m_s, 0.0, 0.0));
      if (frame == half) settled = simulation.state.position;
      const double speed = rootMeanSquareCornerSpeed(simulation.state.velocity);
      if (frame > half) squares += speed * speed / static_cast<double>(frames - 1 - half);
      if (!standing(simulation.model, start, simulation.state.position).stands) {
        point.verdict = MapVerdict::blowsUp;
        return point;
      }
      if (threadTime_s() - begin_s > limits.case_s) {
        point.verdict = MapVerdict::timesOut;
        return point;
      }
    }
  } catch (const DivergenceError&) {
    point.verdict = MapVerdict::blowsUp;
    return point;
  }
  PenetrationWorkspace workspace;
  const ParticleArray& position = simulation.state.position;
  point.verdict = verdictOf({std::sqrt(squares), largestCornerMove(settled, position),
                             maxPenetration(position, true, workspace).depth, std::abs(topHeightError(closed, position)) / rows},
                            0.5 * limits.seconds);
  return point;
}

bool calm(const MapPoint& point) {
  return point.verdict != MapVerdict::jitters && point.verdict != MapVerdict::blowsUp && point.verdict != MapVerdict::timesOut;
}

// All steps, then the boundary between the longest calm step and the next longer one.
void lookAlong(MapRow& row, const MapLimits& limits) {
  std::vector<MapPoint> line;
  for (const int steps : limits.steps) {
    if (!line.empty() && line.back().verdict == MapVerdict::timesOut) {  // shorter steps take longer still
      line.push_back(line.back());
      line.back().steps = steps;
      line.back().step_s = line[0].step_s * line[0].steps / steps;
    } else {
      line.push_back(tried(row.method, row.rows, row.tolerance_m, steps, limits));
    }
  }
  double omega = 0.0;  // of those that came through their first frame
  for (const MapPoint& point : line) omega = std::max(omega, point.verdict == MapVerdict::blowsUp ? 0.0 : point.omega);
  for (MapPoint& point : line) point.omega = omega;
  row.points = line;
  const auto first = std::find_if(line.begin(), line.end(), calm);
  if (first == line.begin() || first == line.end()) return;
  MapPoint last = *first;
  int tooFew = (first - 1)->steps;
  for (int i = 0; i < kBisections && last.steps - tooFew > 1; ++i) {
    const int middle = static_cast<int>(std::lround(std::sqrt(static_cast<double>(tooFew) * last.steps)));
    const int steps = std::clamp(middle, tooFew + 1, last.steps - 1);
    const MapPoint point = tried(row.method, row.rows, row.tolerance_m, steps, limits);
    if (calm(point)) {
      last = point;
      last.omega = omega;
    } else {
      tooFew = point.steps;
    }
  }
  row.boundary.push_back(last);
}

std::vector<StabilityMap> emptyMaps(const MapLimits& limits) {
  std::vector<StabilityMap> maps;
  for (const Method method : limits.methods.empty() ? mappedMethods() : limits.methods) {
    if (!isRigid(method)) maps.push_back({method, MapAxis::stiffness, {}, {}});
    maps.push_back({method, MapAxis::rows, {}, {}});
  }
  return maps;
}

// In the order of the maps.
std::vector<MapRow> rowsOf(const std::vector<StabilityMap>& maps, const MapLimits& limits) {
  constexpr int kRowsOverStiffness = 3;
  std::vector<MapRow> rows;
  for (const StabilityMap& map : maps) {
    if (map.axis == MapAxis::stiffness) {
      for (const double tolerance_m : limits.tolerances_m)
        rows.push_back({map.method, map.axis, kRowsOverStiffness, tolerance_m});
    } else {
      for (const int count : limits.rows) rows.push_back({map.method, map.axis, count, kMapTolerance_m});
    }
  }
  return rows;
}

}  // namespace

bool isSame(const MapRow& a, const MapRow& b) {
  return a.method == b.method && a.axis == b.axis && a.rows == b.rows && a.tolerance_m == b.tolerance_m;
}

std::vector<Method> mappedMethods() {
  return {kMapped.begin(), kMapped.end()};
}

int mapRows(const MapLimits& limits) {
  return static_cast<int>(rowsOf(emptyMaps(limits), limits).size());
}

std::vector<StabilityMap> measureMaps(const MapLimits& limits, const std::vector<MapRow>& kept,
                                      const std::function<void(const MapRow&)>& progress) {
  std::vector<StabilityMap> maps = emptyMaps(limits);
  std::vector<MapRow> rows = rowsOf(maps, limits);
  std::mutex mutex;
  tbb::parallel_for(std::size_t{0}, rows.size(), [&](std::size_t i) {
    const auto known = std::find_if(kept.begin(), kept.end(), [&](const MapRow& row) { return isSame(row, rows[i]); });
    if (known != kept.end()) {
      rows[i] = *known;
    } else {
      // Apart from the others, whose time a waiting thread would else count as this one's.
      tbb::this_task_arena::isolate([&] { lookAlong(rows[i], limits); });
    }
    const std::scoped_lock lock(mutex);
    progress(rows[i]);
  });
  for (StabilityMap& map : maps) {
    for (const MapRow& row : rows) {
      if (row.method != map.method || row.axis != map.axis) continue;
      map.points.insert(map.points.end(), row.points.begin(), row.points.end());
      map.boundary.insert(map.boundary.end(), row.boundary.begin(), row.boundary.end());
    }
  }
  return maps;
}

double longestStableStep(Method method, double omega) {
  if (!(omega > 0.0)) return 0.0;
  if (method == Method::semiImplicitEuler) return 2.0 / omega;
  if (method == Method::rungeKutta4) return 2.0 * std::sqrt(2.0) / omega;
  return 0.0;
}

}  // namespace springtower
