#include "apps/plot/canvas.h"

#include "apps/plot/plot.h"

#include <cmath>
#include <fmt/format.h>
#include <numbers>
#include <ostream>
#include <sstream>

namespace springtower {
namespace {

// The first eight: Okabe and Ito 2008, yellow, which is weak on white, last.
constexpr std::array<Ink, kPlotStyles> kInks = {{{0.0, 0.447, 0.698},
                                                 {0.835, 0.369, 0.0},
                                                 {0.0, 0.62, 0.451},
                                                 {0.8, 0.475, 0.655},
                                                 {0.337, 0.706, 0.914},
                                                 {0.902, 0.624, 0.0},
                                                 {0.35, 0.35, 0.35},
                                                 {0.85, 0.78, 0.1},
                                                 {0.55, 0.34, 0.24},
                                                 {0.68, 0.72, 0.8},
                                                 {0.42, 0.2, 0.55},
                                                 {0.0, 0.3, 0.33},
                                                 {0.75, 0.15, 0.3},
                                                 {0.4, 0.5, 0.1},
                                                 {0.95, 0.55, 0.6}}};

}  // namespace

const Ink& inkOf(std::size_t style) {
  return kInks[style % kInks.size()];
}

Canvas::Canvas(cairo_surface_t* surface) : cairo_(cairo_create(surface), cairo_destroy) {
  cairo_select_font_face(get(), "sans-serif", CAIRO_FONT_SLANT_NORMAL, CAIRO_FONT_WEIGHT_NORMAL);
  // Without hinting text is as wide on every surface, so that SVG and PNG agree.
  const std::unique_ptr<cairo_font_options_t, decltype(&cairo_font_options_destroy)> options(cairo_font_options_create(),
                                                                                             cairo_font_options_destroy);
  cairo_font_options_set_hint_metrics(options.get(), CAIRO_HINT_METRICS_OFF);
  cairo_font_options_set_hint_style(options.get(), CAIRO_HINT_STYLE_NONE);
  cairo_font_options_set_antialias(options.get(), CAIRO_ANTIALIAS_GRAY);
  cairo_set_font_options(get(), options.get());
}

void Canvas::ink(const Ink& ink) {
  cairo_set_source_rgb(get(), ink.red, ink.green, ink.blue);
}

double Canvas::textWidth(const std::string& text, double size) {
  cairo_set_font_size(get(), size);
  cairo_text_extents_t extents;
  cairo_text_extents(get(), text.c_str(), &extents);
  return extents.x_advance;
}

std::vector<std::string> Canvas::wrapped(const std::string& text, double size, double width) {
  std::vector<std::string> lines;
  std::string line;
  std::istringstream words(text);
  for (std::string word; words >> word;) {
    const std::string longer = line.empty() ? word : fmt::format("{} {}", line, word);
    if (!line.empty() && textWidth(longer, size) > width) {
      lines.push_back(line);
      line = word;
    } else {
      line = longer;
    }
  }
  if (!line.empty()) lines.push_back(line);
  return lines;
}

void Canvas::text(double x, double y, const std::string& text, double size, Anchor anchor) {
  const double shift = anchor == Anchor::start ? 0.0 : textWidth(text, size) * (anchor == Anchor::middle ? 0.5 : 1.0);
  cairo_set_font_size(get(), size);
  cairo_move_to(get(), x - shift, y);
  cairo_show_text(get(), text.c_str());
}

void Canvas::segment(double x0, double y0, double x1, double y1, double width, bool dashed) {
  cairo_move_to(get(), x0, y0);
  cairo_line_to(get(), x1, y1);
  stroke(width, dashed);
}

void Canvas::stroke(double width, bool dashed) {
  const double dash[] = {4.0, 3.0};
  cairo_set_dash(get(), dash, dashed ? 2 : 0, 0.0);
  cairo_set_line_width(get(), width);
  cairo_stroke(get());
}

void Canvas::box(double x, double y, double width, double height) {
  cairo_rectangle(get(), x, y, width, height);
  cairo_fill(get());
}

void Canvas::marker(double x, double y, std::size_t style, bool filled) {
  const auto polygon = [&](int corners, double turn) {
    for (int i = 0; i < corners; ++i) {
      const double angle = 2.0 * std::numbers::pi * i / corners + turn;
      cairo_line_to(get(), x + 1.2 * kMarkerRadius * std::sin(angle), y - 1.2 * kMarkerRadius * std::cos(angle));
    }
  };
  cairo_new_path(get());
  switch (style % 4) {
    case 0:
      cairo_arc(get(), x, y, kMarkerRadius, 0.0, 2.0 * std::numbers::pi);
      break;
    case 1:
      polygon(4, 0.25 * std::numbers::pi);
      break;
    case 2:
      polygon(3, 0.0);
      break;
    default:
      polygon(4, 0.0);
      break;
  }
  cairo_close_path(get());
  ink(filled ? inkOf(style) : kWhite);
  cairo_fill_preserve(get());
  ink(inkOf(style));
  stroke(1.1, false);
}

cairo_status_t toStream(void* stream, const unsigned char* data, unsigned int length) {
  auto& out = *static_cast<std::ostream*>(stream);
  out.write(reinterpret_cast<const char*>(data), static_cast<std::streamsize>(length));
  return out ? CAIRO_STATUS_SUCCESS : CAIRO_STATUS_WRITE_ERROR;
}

}  // namespace springtower
