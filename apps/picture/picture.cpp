#include "apps/picture/picture.h"

#include "apps/common/look.h"
#include "apps/picture/raster.h"
#include "apps/plot/canvas.h"
#include "core/error.h"

#include <algorithm>
#include <array>
#include <cairo.h>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <numbers>
#include <ostream>
#include <vector>

namespace springtower {
namespace {

using LinearColour = Eigen::Array3d;

constexpr double kRadians = std::numbers::pi / 180.0;
constexpr int kSamples = 3;        // a pixel is the mean of 3 x 3 samples
constexpr int kShadowSize = 2048;  // of the shadow map, a side

LinearColour colourOf(const look::Rgb& rgb) {
  return {rgb[0], rgb[1], rgb[2]};
}
const LinearColour kBackground = colourOf(look::kBackdrop);
const LinearColour kFloorColour = colourOf(look::kTable);
const LinearColour kGridColour = 0.82 * kFloorColour;
const LinearColour kEdgeColour = colourOf(look::kEdge);

// What is drawn: all blocks but those far away from the rest.
struct Subject {
  std::vector<Vec3> corners;
  Vec3 middle;
  double radius = 0.0;
};

Subject subjectOf(const ParticleArray& position) {
  const std::size_t blocks = position.blockCount();
  std::vector<double> values(blocks);
  const auto median = [&values] {
    const auto half = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), half, values.end());
    return *half;
  };
  Vec3 medianCentre;
  for (Eigen::Index a = 0; a < 3; ++a) {
    for (std::size_t b = 0; b < blocks; ++b) values[b] = centre(position, b)[a];
    medianCentre[a] = median();
  }
  for (std::size_t b = 0; b < blocks; ++b) values[b] = (centre(position, b) - medianCentre).norm();
  const double far = 4.0 * median() + 2.0 * (position.at(0, 0) - position.at(0, 7)).norm();
  Subject subject;
  Vec3 low = Vec3::Constant(std::numeric_limits<double>::infinity());
  Vec3 high = -low;
  for (std::size_t b = 0; b < blocks; ++b) {
    if ((centre(position, b) - medianCentre).norm() > far) continue;
    for (std::size_t c = 0; c < kCorners; ++c) {
      const Vec3 corner = position.at(b, c);
      subject.corners.push_back(corner);
      low = low.cwiseMin(corner);
      high = high.cwiseMax(corner);
    }
  }
  subject.middle = 0.5 * (low + high);
  subject.radius = 0.5 * (high - low).norm();
  return subject;
}

// A view that holds the subject with a margin, and the picture's size for it.
struct Frame {
  View view;
  int width = 0;
  int height = 0;
};

Frame frameOf(const Subject& subject, const PictureOptions& options) {
  const double azimuth = kRadians * options.azimuth_deg;
  const double elevation = kRadians * options.elevation_deg;
  const Vec3 towardsViewer(std::cos(elevation) * std::cos(azimuth), std::cos(elevation) * std::sin(azimuth), std::sin(elevation));
  Frame frame{View(subject.middle, towardsViewer)};
  View& view = frame.view;
  view.distance = 6.0 * subject.radius;
  double left = 0.0;
  double right = 0.0;
  double top = 0.0;
  double bottom = 0.0;
  for (const Vec3& corner : subject.corners) {
    const Vec3 screen = view.project(corner);
    left = std::min(left, screen.x());
    right = std::max(right, screen.x());
    top = std::min(top, screen.y());
    bottom = std::max(bottom, screen.y());
  }
  const double margin = 0.12 * std::max(right - left, bottom - top);
  const double wide = std::max(right - left + 2.0 * margin, 0.62 * (bottom - top + 2.0 * margin));
  const double high = std::max(bottom - top + 2.0 * margin, 0.62 * wide);
  const double scale = std::sqrt(options.pixels / (wide * high));
  frame.width = std::max(16, static_cast<int>(std::lround(wide * scale)));
  frame.height = std::max(16, static_cast<int>(std::lround(high * scale)));
  view.scale = kSamples * scale;
  view.x = kSamples * (0.5 * frame.width - 0.5 * scale * (left + right));
  view.y = kSamples * (0.5 * frame.height - 0.5 * scale * (top + bottom));
  return frame;
}

// Edges are a pixel wide, less on blocks that are only a few pixels high.
double edgeWidth(const ParticleArray& position, const View& view) {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t a = 0; a < 3; ++a) least = std::min(least, meanEdge(position, 0, a).norm());
  return std::min(0.7 * kSamples, 0.05 * least * view.scale);
}

// Draws samples of a scene: light, shadow, floor.
class Painter {
 public:
  Painter(const ParticleArray& position, bool floor, const Subject& subject, const View& view)
      : floor_(floor), subject_(subject), view_(view), light_(subject.middle, light(view)), shadow_(kShadowSize, kShadowSize) {
    light_.scale = 0.45 * kShadowSize / subject.radius;
    light_.x = 0.5 * kShadowSize;
    light_.y = 0.5 * kShadowSize;
    drawBlocks(shadow_, light_, position, 0.0);
    square_ = 0.02;
    while (square_ < 0.08 * subject.radius) square_ *= 5.0;
    for (std::size_t b = 0; b < position.blockCount(); ++b) {
      for (std::size_t f = 0; f < kFaces; ++f) looks_.push_back(lookOf(position, b, f));
    }
  }

  [[nodiscard]] LinearColour block(std::int32_t mark, int column, int line, float nearness) const {
    const Look& look = looks_[static_cast<std::size_t>(mark / 2)];
    const Vec3 point = pointAt(column, line, nearness) + 0.004 * subject_.radius * look.normal;
    const LinearColour& colour = mark % 2 == 1 ? look.edge : look.wood;
    return colour * (look.shade + (look.sun > 0.0 && isLit(point, column, line) ? look.sun : 0.0));
  }

  [[nodiscard]] LinearColour background(int column, int line) const {
    if (!floor_) return kBackground;
    // The ray from the eye through the sample, against the floor.
    const Vec3 eye = view_.middle + view_.distance * view_.back;
    const Vec3 onScreen =
        view_.middle + (column - view_.x) / view_.scale * view_.right - (line - view_.y) / view_.scale * view_.up;
    const Vec3 ray = onScreen - eye;
    if (ray.z() >= 0.0) return kBackground;
    const Vec3 point = eye - eye.z() / ray.z() * ray;
    const double away = std::hypot(point.x() - subject_.middle.x(), point.y() - subject_.middle.y()) / subject_.radius;
    const double fade = std::clamp(2.0 - 0.75 * away, 0.0, 1.0);
    if (fade <= 0.0) return kBackground;
    const bool onLine = std::min(toLine(point.x()), toLine(point.y())) < std::min(0.018 * square_, 0.0016 * subject_.radius);
    const LinearColour plain = onLine ? kGridColour : kFloorColour;
    const LinearColour shaded = plain * (isLit(point, column, line) ? 1.0 : 0.80);
    return kBackground + fade * fade * (3.0 - 2.0 * fade) * (shaded - kBackground);
  }

 private:
  // A face under this light, whatever covers it.
  struct Look {
    Vec3 normal;
    LinearColour wood;
    LinearColour edge;
    double shade;  // brightness without sun
    double sun;    // what the sun adds
  };

  [[nodiscard]] Look lookOf(const ParticleArray& position, std::size_t block, std::size_t face) const {
    const auto corner = [&](std::size_t i) { return position.at(block, static_cast<std::size_t>(kFaceCorners[face][i])); };
    Look look;
    look.normal = (corner(2) - corner(0)).cross(corner(3) - corner(1)).normalized();
    const bool end = face < 2;
    look.wood = colourOf(look::woodOf(static_cast<std::uint32_t>(block))) * (end ? look::kEndGrain : 1.0);
    look.edge = 0.5 * look.wood + 0.5 * kEdgeColour;
    look.shade = 0.66 + 0.06 * look.normal.z();
    look.sun = 0.36 * std::max(0.0, look.normal.dot(light_.back));
    return look;
  }

  // The sun stands behind the viewer's left shoulder.
  static Vec3 light(const View& view) {
    return look::kSun[0] * view.back + look::kSun[1] * view.right + look::kSun[2] * Vec3::UnitZ();
  }

  [[nodiscard]] double toLine(double value) const { return std::abs(value - square_ * std::round(value / square_)); }

  // Undoes View::project.
  [[nodiscard]] Vec3 pointAt(int column, int line, float nearness) const {
    const double shrink = nearness;
    return view_.middle + (column - view_.x) / (view_.scale * shrink) * view_.right -
           (line - view_.y) / (view_.scale * shrink) * view_.up + view_.distance * (1.0 - 1.0 / shrink) * view_.back;
  }

  // Whether the sun reaches a point. Each sample of a pixel looks at a place of its own in the shadow map: soft borders.
  [[nodiscard]] bool isLit(const Vec3& point, int sampleColumn, int sampleLine) const {
    const Vec3 place = light_.project(point);
    const int column = static_cast<int>(std::lround(place.x())) + 2 * (sampleColumn % kSamples - 1);
    const int line = static_cast<int>(std::lround(place.y())) + 2 * (sampleLine % kSamples - 1);
    if (column < 0 || line < 0 || column >= kShadowSize || line >= kShadowSize) return true;
    return shadow_.nearness[shadow_.at(column, line)] <= place.z() + 0.003 * subject_.radius;
  }

  bool floor_;
  const Subject& subject_;
  const View& view_;
  View light_;
  Raster shadow_;
  double square_;
  std::vector<Look> looks_;  // of each face
};

std::uint32_t packed(const LinearColour& colour) {
  std::uint32_t value = 0xff;
  for (Eigen::Index a = 0; a < 3; ++a) {
    value = (value << 8U) | static_cast<std::uint32_t>(std::lround(255.0 * std::clamp(colour[a], 0.0, 1.0)));
  }
  return value;
}

}  // namespace

void writePicture(std::ostream& stream, const ParticleArray& position, bool floor, const PictureOptions& options) {
  const Subject subject = subjectOf(position);
  const Frame frame = frameOf(subject, options);
  Raster raster(kSamples * frame.width, kSamples * frame.height);
  drawBlocks(raster, frame.view, position, edgeWidth(position, frame.view));
  const Painter painter(position, floor, subject, frame.view);

  std::vector<std::uint32_t> pixels;
  pixels.reserve(static_cast<std::size_t>(frame.width) * static_cast<std::size_t>(frame.height));
  for (int y = 0; y < frame.height; ++y) {
    for (int x = 0; x < frame.width; ++x) {
      LinearColour sum = LinearColour::Zero();
      for (int sample = 0; sample < kSamples * kSamples; ++sample) {
        const int column = kSamples * x + sample % kSamples;
        const int line = kSamples * y + sample / kSamples;
        const std::size_t i = raster.at(column, line);
        sum += raster.face[i] < 0 ? painter.background(column, line)
                                  : painter.block(raster.face[i], column, line, raster.nearness[i]);
      }
      pixels.push_back(packed(sum / (kSamples * kSamples)));
    }
  }
  const std::unique_ptr<cairo_surface_t, decltype(&cairo_surface_destroy)> surface(
      cairo_image_surface_create_for_data(reinterpret_cast<unsigned char*>(pixels.data()), CAIRO_FORMAT_RGB24, frame.width,
                                          frame.height, 4 * frame.width),
      cairo_surface_destroy);
  const cairo_status_t status = cairo_surface_write_to_png_stream(surface.get(), toStream, &stream);
  if (status == CAIRO_STATUS_WRITE_ERROR) return;  // the stream has failed: whoever has opened it can name the file
  if (status != CAIRO_STATUS_SUCCESS) {
    throw InputError(std::string("expected a picture that can be drawn, got: ") + cairo_status_to_string(status));
  }
}

}  // namespace springtower
