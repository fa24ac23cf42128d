#pragma once

#include <iosfwd>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace springtower {

/// How the points of a line are marked. Hollow ones are for figures that were not measured in the same run.
/// Rings go round other lines' markers.
enum class Marker { none, filled, hollow, ring };

/// One axis. Limits that are not given come from the data and are widened to whole ticks; a logarithmic axis leaves out what is
/// not positive.
struct PlotAxis {
  std::string title;  ///< with its unit: "penetration, mm"
  bool logarithmic = false;
  std::optional<double> least = {};
  std::optional<double> most = {};
  std::vector<std::pair<double, std::string>> labels = {};  ///< ticks by hand, for bars that have names; else they are chosen
};

/// Lines of one plot that differ in colour.
inline constexpr int kPlotStyles = 15;

struct PlotPoint {
  double x;
  double y;
};

/// Points and the line through them. A point that is not finite (or not positive on a logarithmic axis) interrupts the line.
struct PlotLine {
  std::string name;  ///< in the legend; an empty one is left out of it
  std::vector<PlotPoint> points;
  Marker marker = Marker::filled;
  bool joined = true;
  bool dashed = false;
  int style = -1;  ///< colour and shape of the marker, below kPlotStyles and then round again; -1: the line's place
  std::vector<std::string> labels = {};  ///< written beside the points, [points] or empty
};

/// A horizontal line at a value worth knowing, with its name on it.
struct PlotReference {
  double y;
  std::string name;
};

/// Bars from left[i] to right[i] on the x axis, whose layers are stacked upwards from 0.
struct PlotBars {
  struct Layer {
    std::string name;
    std::vector<double> heights;  ///< [bars]
  };
  std::vector<double> left = {};
  std::vector<double> right = {};
  std::vector<Layer> layers = {};
};

/// A chart for print: one plane with lines, bars and reference lines, its legend at the right.
struct Plot {
  std::string title;
  std::string subtitle;
  std::string footnote;  ///< small, wrapped: where the figures come from
  PlotAxis x;
  PlotAxis y;
  std::vector<PlotLine> lines = {};
  std::vector<PlotReference> references = {};
  PlotBars bars = {};
};

/// Bars, one layer, that count how many of the values fall into each of `bins` (at least 1) equally wide parts of their range.
/// Values that are not finite are left out.
PlotBars histogram(const std::string& name, const std::vector<double>& values, std::size_t bins);

/// Writes a chart as SVG (letters as outlines, so that it looks the same everywhere), as PNG (three pixels a point) and as PDF.
/// The same chart gives the same bytes; so a PDF says nothing of when it was made. A stream that takes no more is left
/// failed.
void writeSvg(std::ostream& stream, const Plot& plot);
void writePng(std::ostream& stream, const Plot& plot);
void writePdf(std::ostream& stream, const Plot& plot);

/// Writes a chart into that folder as NAME.svg, NAME.png and NAME.pdf. Throws InputError as OutputFile does.
void writePlot(const std::string& folder, const std::string& name, const Plot& plot);

}  // namespace springtower
