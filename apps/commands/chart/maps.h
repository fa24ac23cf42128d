#pragma once

#include "apps/common/provenance.h"
#include "apps/plot/plot.h"
#include "core/settings.h"

#include <array>
#include <functional>
#include <iosfwd>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace springtower {

/// How a small tower that has been nudged takes a step, worst last; or that it took more processor time than it was given.
enum class MapVerdict { stands, sags, creeps, jitters, blowsUp, timesOut };
inline constexpr std::array<std::string_view, 6> kMapVerdictNames = {"stands",  "sags",     "creeps",
                                                                     "jitters", "blows up", "times out"};
constexpr std::string_view nameOf(MapVerdict verdict) {
  return kMapVerdictNames[static_cast<std::size_t>(verdict)];
}

/// What a map has on its vertical axis beside the step on the horizontal one.
enum class MapAxis { stiffness, rows };

/// One tower that was tried.
struct MapPoint {
  int steps = 1;           ///< of a frame of 1/60 s
  double step_s = 0.0;     ///< s
  double stiffness = 0.0;  ///< N/m, of a contact point; 0 for rigid blocks
  int rows = 1;
  double omega =
      0.0;  ///< 1/s, largest angular frequency, from the bound in closed form (solver/explicit/stable_step.h); 0 where not known
  MapVerdict verdict = MapVerdict::stands;
};

struct StabilityMap {
  Method method = Method::implicit;
  MapAxis axis = MapAxis::rows;
  std::vector<MapPoint> points;
  std::vector<MapPoint> boundary;  ///< for each stiffness or number of rows the longest step that neither jitters nor blows up,
                                   ///< found by bisection; none where there is none or no end
};

/// A row of a map: one stiffness, or one number of rows, with all steps.
struct MapRow {
  Method method = Method::implicit;
  MapAxis axis = MapAxis::rows;
  int rows = 1;
  double tolerance_m = 0.0;
  std::vector<MapPoint> points = {};    ///< as in StabilityMap
  std::vector<MapPoint> boundary = {};  ///< none or one
};

/// Whether both are the same row of the same map, whatever was found in it.
bool isSame(const MapRow& a, const MapRow& b);

/// How finely and how long to look.
struct MapLimits {
  std::vector<int> steps = {1, 2, 4, 8, 16, 32, 64, 128, 256, 512};
  std::vector<double> tolerances_m = {1e-3, 5e-4, 2e-4, 1e-4, 5e-5, 2e-5};
  std::vector<int> rows = {1, 2, 3, 6, 9, 12, 18};
  double seconds = 1.0;              ///< s simulated
  double case_s = 5.0;               ///< s, processor time after which a tower has timed out, and with it those of shorter steps
  std::vector<Method> methods = {};  ///< none: all that can be mapped, mappedMethods
};

/// Sag that a map calls by its name, m: of a row, or as penetration; also the tolerance of maps over rows.
inline constexpr double kMapTolerance_m = 1e-4;

/// Every method but `auto`, which is another one by the time it steps, and `implicit-eigen`, whose steps are those of `implicit`.
std::vector<Method> mappedMethods();

/// All maps: over step and stiffness for the methods that have one, over step and rows for these and the rigid ones. Rows that
/// are `kept` are not measured again. `progress` is called after each row, by one thread at a time; there are mapRows(limits) of
/// them. Throws Interrupted.
std::vector<StabilityMap> measureMaps(const MapLimits& limits, const std::vector<MapRow>& kept,
                                      const std::function<void(const MapRow&)>& progress);
int mapRows(const MapLimits& limits);

/// The longest stable step of theory, s: 2/w for semi-implicit Euler, 2.83/w for Runge-Kutta 4, none (0) for others. Of
/// undamped midpoint no step is stable.
double longestStableStep(Method method, double omega);

/// The maps as charts with a file name without extension, as a table, and as an index page.
std::vector<std::pair<std::string, Plot>> mapPlots(const std::vector<StabilityMap>& maps, const Provenance& provenance);
void writeMapsCsv(std::ostream& stream, const std::vector<StabilityMap>& maps, const Provenance& provenance);
void writeMapsIndex(std::ostream& stream, const std::vector<StabilityMap>& maps, const std::vector<std::string>& names,
                    const Provenance& provenance);

}  // namespace springtower
