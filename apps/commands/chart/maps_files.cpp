#include "apps/commands/chart/maps.h"
#include "apps/common/output_file.h"

#include <fmt/format.h>
#include <ostream>

namespace springtower {
namespace {

// Green, orange, violet, yellow, red, pale.
constexpr std::array<int, kMapVerdictNames.size()> kVerdictStyles = {2, 5, 3, 7, 1, 9};
constexpr int kBoundaryStyle = 6;
constexpr int kTheoryStyle = 0;

double otherOf(const StabilityMap& map, const MapPoint& point) {
  return map.axis == MapAxis::stiffness ? point.stiffness : static_cast<double>(point.rows);
}

std::string_view nameOf(MapAxis axis) {
  return axis == MapAxis::stiffness ? "stiffness" : "rows";
}

std::string theoryOf(Method method) {
  switch (method) {
    case Method::semiImplicitEuler:
      return "theory: 2/w";
    case Method::rungeKutta4:
      return "theory: 2.83/w";
    case Method::midpoint:
      return "theory: no step is stable without dashpots";
    case Method::implicit:
    case Method::implicitEuler:
      return "theory: any step is stable";
    default:
      return "theory: none";
  }
}

Plot plotOf(const StabilityMap& map, const Provenance& provenance) {
  Plot plot;
  plot.title = fmt::format("Stability: {} over step and {}", nameOf(map.method), nameOf(map.axis));
  plot.subtitle =
      map.axis == MapAxis::stiffness ? "a tower of 3 rows, nudged, without dashpots; " : "towers nudged, without dashpots; ";
  plot.subtitle += theoryOf(map.method);
  plot.x = {"step, s", true};
  plot.y = {map.axis == MapAxis::stiffness ? "stiffness of a contact point, N/m" : "rows", true};
  for (std::size_t v = 0; v < kMapVerdictNames.size(); ++v) {
    PlotLine line{std::string(kMapVerdictNames[v]), {}, Marker::filled, false};
    line.style = kVerdictStyles[v];
    for (const MapPoint& point : map.points) {
      if (point.verdict == static_cast<MapVerdict>(v)) line.points.push_back({point.step_s, otherOf(map, point)});
    }
    if (!line.points.empty()) plot.lines.push_back(std::move(line));
  }
  PlotLine boundary{"boundary, by bisection", {}, Marker::hollow};
  boundary.style = kBoundaryStyle;
  PlotLine theory{theoryOf(map.method), {}, Marker::none};
  theory.style = kTheoryStyle;
  theory.dashed = true;
  for (const MapPoint& point : map.boundary) boundary.points.push_back({point.step_s, otherOf(map, point)});
  double before = 0.0;
  for (const MapPoint& point : map.points) {
    const double limit_s = longestStableStep(map.method, point.omega);
    const double other = otherOf(map, point);
    if (limit_s > 0.0 && other != before) theory.points.push_back({limit_s, other});  // once a row of the map
    before = other;
  }
  if (!boundary.points.empty()) plot.lines.push_back(std::move(boundary));
  if (!theory.points.empty()) plot.lines.push_back(std::move(theory));
  plot.footnote = fmt::format(
      "Worst of what it does after a nudge of 0.5 mm/s: blows up or falls; jitters, above 1 mm/s; creeps, more than {0:g} mm/s; "
      "sags, a row or a penetration of more than {1:g} mm; stands. w from the bound of the largest eigenvalue, which is at most "
      "8 % high: w at most 4 %. "
      "{2}",
      1e3 * kMapTolerance_m, 1e3 * kMapTolerance_m, footnote(provenance));
  return plot;
}

}  // namespace

std::vector<std::pair<std::string, Plot>> mapPlots(const std::vector<StabilityMap>& maps, const Provenance& provenance) {
  std::vector<std::pair<std::string, Plot>> plots;
  for (const StabilityMap& map : maps) {
    std::string name = fmt::format("map_{}_{}", nameOf(map.method), nameOf(map.axis));
    for (char& c : name) c = c == '-' ? '_' : c;
    plots.emplace_back(name, plotOf(map, provenance));
  }
  return plots;
}

void writeMapsCsv(std::ostream& stream, const std::vector<StabilityMap>& maps, const Provenance& provenance) {
  stream << "method,over,kind,steps_per_frame,step_s,stiffness_n_m,rows,omega_1_s,longest_stable_step_s,verdict,commit,compiler,"
            "flags,cpu,date\n";
  const auto write = [&](const StabilityMap& map, const MapPoint& point, std::string_view kind) {
    stream << fmt::format("{},{},{},{},{:.6g},{:.6g},{},{:.6g},{:.6g},{},{},{},{},{},{}\n", nameOf(map.method), nameOf(map.axis),
                          kind, point.steps, point.step_s, point.stiffness, point.rows, point.omega,
                          longestStableStep(map.method, point.omega), csvText(nameOf(point.verdict)), provenance.commit,
                          csvText(provenance.compiler), csvText(provenance.flags), csvText(provenance.processor),
                          provenance.date);
  };
  for (const StabilityMap& map : maps) {
    for (const MapPoint& point : map.points) write(map, point, "grid");
    for (const MapPoint& point : map.boundary) write(map, point, "boundary");
  }
}

void writeMapsIndex(std::ostream& stream, const std::vector<StabilityMap>& maps, const std::vector<std::string>& names,
                    const Provenance& provenance) {
  stream
      << "# Where methods are stable\n\nEvery figure is in [maps.csv](maps.csv).\n\n"
      << footnote(provenance)
      << "\n\n## The longest step that neither jitters nor blows up\n\nBy bisection; its ratio to theory where there is one.\n\n"
         "| method | stiffness, N/m | rows | step, ms | over theory |\n|---|---|---|---|---|\n";
  for (const StabilityMap& map : maps) {
    for (const MapPoint& point : map.boundary) {
      const double limit_s = longestStableStep(map.method, point.omega);
      stream << fmt::format("| {} | {} | {} | {:.3g} | {} |\n", nameOf(map.method),
                            point.stiffness > 0.0 ? fmt::format("{:.3g}", point.stiffness) : "rigid", point.rows,
                            1e3 * point.step_s, limit_s > 0.0 ? fmt::format("{:.2f}", point.step_s / limit_s) : "");
    }
  }
  stream << "\n## Maps\n";
  for (const std::string& name : names) stream << fmt::format("\n![{0}]({0}.png) ([SVG]({0}.svg), [PDF]({0}.pdf))\n", name);
}

}  // namespace springtower
