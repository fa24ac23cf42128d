#include "apps/plot/plot.h"

#include "apps/common/output_file.h"
#include "apps/plot/axis.h"
#include "apps/plot/canvas.h"
#include "core/error.h"

#include <algorithm>
#include <array>
#include <cairo-pdf.h>
#include <cairo-svg.h>
#include <cairo.h>
#include <cmath>
#include <memory>
#include <numbers>
#include <ostream>
#include <regex>
#include <sstream>

namespace springtower {
namespace {

// Sizes in points. The plane keeps its size; the legend and the footnote add to it.
constexpr double kPlaneWidth = 460.0;
constexpr double kPlaneHeight = 300.0;
constexpr double kLeft = 64.0;
constexpr double kTop = 52.0;
constexpr double kBelow = 46.0;
constexpr double kGap = 14.0;
constexpr double kLineHeight = 16.0;
constexpr double kText = 10.0;
constexpr double kTitleText = 13.0;
constexpr double kSmallText = 6.5;
constexpr double kLabelText = 8.5;
constexpr double kLegendSample = 24.0;
constexpr int kPixelsPerPoint = 3;

std::size_t styleOf(const Plot& plot, std::size_t line) {
  return plot.lines[line].style >= 0 ? static_cast<std::size_t>(plot.lines[line].style) : line;
}

struct Box {
  double x;
  double y;
  double width;
  double height;

  [[nodiscard]] bool meets(const Box& other) const {
    return x < other.x + other.width && other.x < x + width && y < other.y + other.height && other.y < y + height;
  }
  [[nodiscard]] bool inside(const Box& other) const {
    return x >= other.x && y >= other.y && x + width <= other.x + other.width && y + height <= other.y + other.height;
  }
};

struct LegendEntry {
  const std::string* name;
  std::size_t style;
  const PlotLine* line;  // null for a layer of bars
};

// Lines in their order; layers from the top of the stack down, as they are seen.
std::vector<LegendEntry> legendOf(const Plot& plot) {
  std::vector<LegendEntry> entries;
  for (std::size_t i = 0; i < plot.lines.size(); ++i) {
    if (!plot.lines[i].name.empty()) entries.push_back({&plot.lines[i].name, styleOf(plot, i), &plot.lines[i]});
  }
  for (std::size_t i = plot.bars.layers.size(); i-- > 0;) entries.push_back({&plot.bars.layers[i].name, i, nullptr});
  return entries;
}

// A chart laid out: scales, sizes, what is written where.
class Drawing {
 public:
  Drawing(Canvas& canvas, const Plot& plot) : canvas_(canvas), plot_(plot), legend_(legendOf(plot)) {
    std::vector<double> xs;
    std::vector<double> ys;
    for (const PlotLine& line : plot.lines) {
      for (const PlotPoint& point : line.points) {
        xs.push_back(point.x);
        ys.push_back(point.y);
      }
    }
    for (const PlotReference& reference : plot.references) ys.push_back(reference.y);
    xs.insert(xs.end(), plot.bars.left.begin(), plot.bars.left.end());
    xs.insert(xs.end(), plot.bars.right.begin(), plot.bars.right.end());
    for (std::size_t i = 0; i < plot.bars.left.size(); ++i) {
      double sum = 0.0;
      for (const PlotBars::Layer& layer : plot.bars.layers) sum += layer.heights[i];
      ys.push_back(sum);
    }
    if (!plot.bars.left.empty() && !plot.y.logarithmic) ys.push_back(0.0);
    x_ = axisScale(plot.x, xs);
    y_ = axisScale(plot.y, ys);
    double widest = 0.0;
    for (const LegendEntry& entry : legend_) widest = std::max(widest, canvas.textWidth(*entry.name, kText));
    width = kLeft + kPlaneWidth + kGap + (legend_.empty() ? 0.0 : kLegendSample + 8.0 + widest + kGap);
    width = std::max(width,
                     kLeft + std::max(canvas.textWidth(plot.title, kTitleText), canvas.textWidth(plot.subtitle, kText)) + kGap);
    footnote_ = canvas.wrapped(plot.footnote, kSmallText, width - 2.0 * kGap);
    height = kTop + kPlaneHeight + kBelow + 1.3 * kSmallText * static_cast<double>(footnote_.size()) + 4.0;
  }

  void draw() {
    canvas_.ink(kWhite);
    canvas_.box(0.0, 0.0, width, height);
    canvas_.ink(kBlack);
    canvas_.text(kLeft, 20.0, plot_.title, kTitleText);
    canvas_.ink(kGrey);
    canvas_.text(kLeft, 36.0, plot_.subtitle, kText);
    double y = kTop + kPlaneHeight + kBelow;
    for (const std::string& line : footnote_) {
      canvas_.text(kGap, y, line, kSmallText);
      y += 1.3 * kSmallText;
    }
    axes();
    cairo_save(canvas_.get());
    cairo_rectangle(canvas_.get(), kLeft - kMarkerRadius - 1.0, kTop - kMarkerRadius - 1.0,
                    kPlaneWidth + 2.0 * kMarkerRadius + 2.0, kPlaneHeight + 2.0 * kMarkerRadius + 2.0);
    cairo_clip(canvas_.get());
    bars();
    references();
    for (std::size_t i = 0; i < plot_.lines.size(); ++i) line(plot_.lines[i], styleOf(plot_, i));
    labels();
    cairo_restore(canvas_.get());
    legend();
  }

  double width = 0.0;  // points
  double height = 0.0;

 private:
  [[nodiscard]] double atX(double value) const { return kLeft + kPlaneWidth * x_.place(value); }
  [[nodiscard]] double atY(double value) const { return kTop + kPlaneHeight * (1.0 - y_.place(value)); }
  [[nodiscard]] bool shows(const PlotPoint& point) const { return x_.shows(point.x) && y_.shows(point.y); }

  void axes() {
    const double bottom = kTop + kPlaneHeight;
    for (const Tick& tick : x_.ticks) {
      const double x = atX(tick.value);
      canvas_.ink(kFaint);
      if (!tick.label.empty() && plot_.x.labels.empty()) canvas_.segment(x, kTop, x, bottom, 0.6);
      canvas_.ink(kBlack);
      canvas_.segment(x, bottom, x, bottom + (tick.label.empty() ? 2.5 : 4.5), 0.8);
      canvas_.text(x, bottom + 16.0, tick.label, kText, Anchor::middle);
    }
    for (const Tick& tick : y_.ticks) {
      const double y = atY(tick.value);
      canvas_.ink(kFaint);
      if (!tick.label.empty()) canvas_.segment(kLeft, y, kLeft + kPlaneWidth, y, 0.6);
      canvas_.ink(kBlack);
      canvas_.segment(kLeft - (tick.label.empty() ? 2.5 : 4.5), y, kLeft, y, 0.8);
      canvas_.text(kLeft - 7.0, y + 3.5, tick.label, kText, Anchor::end);
    }
    canvas_.segment(kLeft, kTop, kLeft, bottom, 0.8);
    canvas_.segment(kLeft, bottom, kLeft + kPlaneWidth, bottom, 0.8);
    canvas_.text(kLeft + 0.5 * kPlaneWidth, bottom + 32.0, plot_.x.title, kText, Anchor::middle);
    cairo_save(canvas_.get());
    cairo_translate(canvas_.get(), 14.0, kTop + 0.5 * kPlaneHeight);
    cairo_rotate(canvas_.get(), -0.5 * std::numbers::pi);
    canvas_.text(0.0, 0.0, plot_.y.title, kText, Anchor::middle);
    cairo_restore(canvas_.get());
  }

  void bars() {
    for (std::size_t i = 0; i < plot_.bars.left.size(); ++i) {
      const double x = atX(plot_.bars.left[i]);
      const double barWidth = atX(plot_.bars.right[i]) - x;
      double sum = 0.0;
      double lower = y_.logarithmic ? kTop + kPlaneHeight : atY(0.0);
      for (std::size_t layer = 0; layer < plot_.bars.layers.size(); ++layer) {
        const double part = plot_.bars.layers[layer].heights[i];
        if (!(part > 0.0) || !std::isfinite(part)) continue;
        sum += part;
        const double upper = atY(sum);
        canvas_.ink(inkOf(layer));
        canvas_.box(x, upper, barWidth, lower - upper);
        lower = upper;
      }
    }
  }

  void references() {
    for (const PlotReference& reference : plot_.references) {
      if (!y_.shows(reference.y)) continue;
      const double y = atY(reference.y);
      canvas_.ink(kGrey);
      canvas_.segment(kLeft, y, kLeft + kPlaneWidth, y, 0.9, true);
      canvas_.text(kLeft + kPlaneWidth - 4.0, y - 3.0, reference.name, kLabelText, Anchor::end);
    }
  }

  void line(const PlotLine& line, std::size_t style) {
    canvas_.ink(inkOf(style));
    bool drawing = false;
    for (const PlotPoint& point : line.points) {
      const bool usable = line.joined && shows(point);
      if (usable && drawing) cairo_line_to(canvas_.get(), atX(point.x), atY(point.y));
      if (usable && !drawing) cairo_move_to(canvas_.get(), atX(point.x), atY(point.y));
      drawing = usable;
    }
    canvas_.stroke(1.5, line.dashed);
    for (std::size_t i = 0; i < line.points.size(); ++i) {
      if (!shows(line.points[i])) continue;
      const double x = atX(line.points[i].x);
      const double y = atY(line.points[i].y);
      mark(line.marker, x, y, style);
    }
  }

  void mark(Marker marker, double x, double y, std::size_t style) {
    if (marker == Marker::ring) {
      canvas_.ink(inkOf(style));
      cairo_new_path(canvas_.get());
      cairo_arc(canvas_.get(), x, y, 2.2 * kMarkerRadius, 0.0, 2.0 * std::numbers::pi);
      canvas_.stroke(1.0, false);
    } else if (marker != Marker::none) {
      canvas_.marker(x, y, style, marker == Marker::filled);
    }
  }

  // Beside their points where there is room: to the right or left, above or below. A label that would lie over a marker or
  // another label everywhere is left out.
  void labels() {
    std::vector<Box> taken;
    for (const PlotLine& line : plot_.lines) {
      for (const PlotPoint& point : line.points) {
        if (!shows(point) || line.marker == Marker::none || line.marker == Marker::ring) continue;
        taken.push_back({atX(point.x) - kMarkerRadius, atY(point.y) - kMarkerRadius, 2.0 * kMarkerRadius, 2.0 * kMarkerRadius});
      }
    }
    for (const PlotReference& reference : plot_.references) {
      const double textWidth = canvas_.textWidth(reference.name, kLabelText);
      taken.push_back({kLeft + kPlaneWidth - 4.0 - textWidth, atY(reference.y) - 3.0 - kLabelText, textWidth, kLabelText});
    }
    const Box plane{kLeft, kTop, kPlaneWidth, kPlaneHeight};
    canvas_.ink(kBlack);
    for (const PlotLine& line : plot_.lines) {
      for (std::size_t i = 0; i < std::min(line.points.size(), line.labels.size()); ++i) {
        if (line.labels[i].empty() || !shows(line.points[i])) continue;
        const double textWidth = canvas_.textWidth(line.labels[i], kLabelText);
        for (const double sideways : {6.0, -6.0 - textWidth}) {
          const double x = atX(line.points[i].x) + sideways;
          const double y = atY(line.points[i].y);
          const auto free = [&](double baseline) {
            const Box box{x, baseline - 0.8 * kLabelText, textWidth, kLabelText};
            return box.inside(plane) &&
                   std::none_of(taken.begin(), taken.end(), [&](const Box& other) { return box.meets(other); });
          };
          const std::array<double, 3> baselines = {y + 0.35 * kLabelText, y - 4.0, y + 4.0 + 0.8 * kLabelText};
          const auto* const place = std::find_if(baselines.begin(), baselines.end(), free);
          if (place == baselines.end()) continue;
          canvas_.text(x, *place, line.labels[i], kLabelText, Anchor::start);
          taken.push_back({x, *place - 0.8 * kLabelText, textWidth, kLabelText});
          break;
        }
      }
    }
  }

  void legend() {
    const double x = kLeft + kPlaneWidth + kGap;
    double y = kTop + 6.0;
    for (const LegendEntry& entry : legend_) {
      canvas_.ink(inkOf(entry.style));
      if (entry.line == nullptr) {
        canvas_.box(x + 6.0, y - 5.0, 12.0, 10.0);
      } else {
        if (entry.line->joined) canvas_.segment(x, y, x + kLegendSample, y, 1.5, entry.line->dashed);
        mark(entry.line->marker, x + 0.5 * kLegendSample, y, entry.style);
      }
      canvas_.ink(kBlack);
      canvas_.text(x + kLegendSample + 8.0, y + 3.5, *entry.name, kText);
      y += kLineHeight;
    }
  }

  Canvas& canvas_;
  const Plot& plot_;
  std::vector<LegendEntry> legend_;
  std::vector<std::string> footnote_;
  AxisScale x_;
  AxisScale y_;
};

using Surface = std::unique_ptr<cairo_surface_t, decltype(&cairo_surface_destroy)>;

void check(cairo_status_t status) {
  // Where the stream has failed whoever has opened it can name the file.
  if (status == CAIRO_STATUS_SUCCESS || status == CAIRO_STATUS_WRITE_ERROR) return;
  throw InputError(std::string("expected a chart that can be drawn, got: ") + cairo_status_to_string(status));
}

// How large the chart becomes: depends on the widths of its words.
std::array<double, 2> sizeOf(const Plot& plot) {
  const Surface scratch(cairo_image_surface_create(CAIRO_FORMAT_A8, 1, 1), cairo_surface_destroy);
  Canvas canvas(scratch.get());
  const Drawing drawing(canvas, plot);
  return {std::ceil(drawing.width), std::ceil(drawing.height)};
}

void drawOn(cairo_surface_t* surface, const Plot& plot, double scale) {
  Canvas canvas(surface);
  cairo_scale(canvas.get(), scale, scale);
  Drawing drawing(canvas, plot);
  drawing.width = std::ceil(drawing.width);
  drawing.height = std::ceil(drawing.height);
  drawing.draw();
  check(cairo_status(canvas.get()));
}

}  // namespace

PlotBars histogram(const std::string& name, const std::vector<double>& values, std::size_t bins) {
  PlotBars bars;
  bars.layers.push_back({name, {}});
  std::vector<double> finite;
  std::copy_if(values.begin(), values.end(), std::back_inserter(finite), [](double value) { return std::isfinite(value); });
  if (finite.empty()) return bars;
  const auto [least, most] = std::minmax_element(finite.begin(), finite.end());
  const double width = *most > *least ? (*most - *least) / static_cast<double>(bins) : 1.0;
  bars.layers[0].heights.assign(bins, 0.0);
  for (std::size_t i = 0; i < bins; ++i) {
    bars.left.push_back(*least + width * static_cast<double>(i));
    bars.right.push_back(*least + width * static_cast<double>(i + 1));
  }
  for (const double value : finite) {
    bars.layers[0].heights[std::min(bins - 1, static_cast<std::size_t>((value - *least) / width))] += 1.0;
  }
  return bars;
}

void writeSvg(std::ostream& stream, const Plot& plot) {
  const auto [width, height] = sizeOf(plot);
  std::ostringstream text;
  const Surface surface(cairo_svg_surface_create_for_stream(toStream, &text, width, height), cairo_surface_destroy);
  drawOn(surface.get(), plot, 1.0);
  cairo_surface_finish(surface.get());
  check(cairo_surface_status(surface.get()));
  // cairo numbers the surfaces of a process; the same chart shall be the same file.
  static const std::regex kSurfaceName("id=\"surface[0-9]+\"");
  stream << std::regex_replace(text.str(), kSurfaceName, "id=\"chart\"");
}

void writePdf(std::ostream& stream, const Plot& plot) {
  // The surface says when it was made; the same chart shall be the same file.
  constexpr const char* kNoDate = "2003-01-01T00:00:00Z";
  const auto [width, height] = sizeOf(plot);
  const Surface surface(cairo_pdf_surface_create_for_stream(toStream, &stream, width, height), cairo_surface_destroy);
  cairo_pdf_surface_set_metadata(surface.get(), CAIRO_PDF_METADATA_CREATE_DATE, kNoDate);
  cairo_pdf_surface_set_metadata(surface.get(), CAIRO_PDF_METADATA_TITLE, plot.title.c_str());
  drawOn(surface.get(), plot, 1.0);
  cairo_surface_finish(surface.get());
  check(cairo_surface_status(surface.get()));
}

void writePng(std::ostream& stream, const Plot& plot) {
  const auto [width, height] = sizeOf(plot);
  const Surface surface(cairo_image_surface_create(CAIRO_FORMAT_RGB24, kPixelsPerPoint * static_cast<int>(width),
                                                   kPixelsPerPoint * static_cast<int>(height)),
                        cairo_surface_destroy);
  drawOn(surface.get(), plot, kPixelsPerPoint);
  check(cairo_surface_write_to_png_stream(surface.get(), toStream, &stream));
}

void writePlot(const std::string& folder, const std::string& name, const Plot& plot) {
  writeOutputFile(folder, name + ".svg", [&](std::ostream& stream) { writeSvg(stream, plot); });
  writeOutputFile(folder, name + ".png", [&](std::ostream& stream) { writePng(stream, plot); });
  writeOutputFile(folder, name + ".pdf", [&](std::ostream& stream) { writePdf(stream, plot); });
}

}  // namespace springtower
