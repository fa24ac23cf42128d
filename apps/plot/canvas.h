#pragma once

#include <array>
#include <cairo.h>
#include <cstddef>
#include <memory>
#include <string>
#include <vector>

namespace springtower {

/// A colour, each part 0 to 1.
struct Ink {
  double red, green, blue;
};
inline constexpr Ink kBlack = {0.13, 0.13, 0.13};
inline constexpr Ink kGrey = {0.42, 0.42, 0.42};
inline constexpr Ink kFaint = {0.9, 0.9, 0.9};
inline constexpr Ink kWhite = {1.0, 1.0, 1.0};

/// The colour of a style; colours that differ for any colour vision come first.
const Ink& inkOf(std::size_t style);

inline constexpr double kMarkerRadius = 3.2;  ///< points

/// Which end of a text stands at its place.
enum class Anchor { start, middle, end };

/// Writes what cairo hands on to the std::ostream that `stream` points to.
cairo_status_t toStream(void* stream, const unsigned char* data, unsigned int length);

/// What a chart is drawn on: a thin cover over cairo, in points, y downwards. The surface must outlive it.
class Canvas {
 public:
  explicit Canvas(cairo_surface_t* surface);
  [[nodiscard]] cairo_t* get() const { return cairo_.get(); }
  /// Sets the colour of what is drawn next.
  void ink(const Ink& ink);
  [[nodiscard]] double textWidth(const std::string& text, double size);
  /// The text in lines no wider than `width`, broken between words; a longer word stands alone.
  [[nodiscard]] std::vector<std::string> wrapped(const std::string& text, double size, double width);
  void text(double x, double y, const std::string& text, double size, Anchor anchor = Anchor::start);
  void segment(double x0, double y0, double x1, double y1, double width, bool dashed = false);
  /// Draws the path built so far on get() and clears it.
  void stroke(double width, bool dashed);
  void box(double x, double y, double width, double height);
  /// Shapes differ from style to style as well as colours, for black and white print.
  void marker(double x, double y, std::size_t style, bool filled);

 private:
  std::unique_ptr<cairo_t, decltype(&cairo_destroy)> cairo_;
};

}  // namespace springtower
