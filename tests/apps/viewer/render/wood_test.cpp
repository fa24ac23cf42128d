// Wood, as the viewer draws it.
#include "tests/support/program.h"

#include <cairo.h>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <fmt/format.h>
#include <fstream>
#include <gtest/gtest.h>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

namespace springtower {
namespace {

constexpr std::size_t kSide = 120;  // pixels
constexpr std::size_t kFiner = 8;   // times as many along a side

// Red, green and blue of a square picture, 0 to 255, row by row: a face of a cube of a metre, seen from this far.
std::vector<double> picture(const std::string& camera, std::size_t side) {
  const ScratchFolder scratch;
  std::ofstream(scratch.file("cube.toml")) << "[[block]]\ndimensions_m = [1.0, 1.0, 1.0]\ncentre_m = [0.0, 0.0, 0.5]\n";
  const ProgramResult result =
      runProgram("springtower-viewer", {"--headless", "--scene", scratch.file("cube.toml"), "--frames", "1", "--png",
                                        scratch.file("png"), "--size", fmt::format("{0}x{0}", side), "--camera", camera});
  EXPECT_EQ(result.exitCode, 0) << result.error;
  const std::unique_ptr<cairo_surface_t, decltype(&cairo_surface_destroy)> image(
      cairo_image_surface_create_from_png((scratch.path() / "png/frame-00001.png").c_str()), cairo_surface_destroy);
  const auto pixels = static_cast<int>(side);
  if (cairo_surface_status(image.get()) != CAIRO_STATUS_SUCCESS || cairo_image_surface_get_width(image.get()) != pixels ||
      cairo_image_surface_get_height(image.get()) != pixels)
    throw std::runtime_error("no picture of this size");
  std::vector<double> values;
  for (std::size_t y = 0; y < side; ++y) {
    const auto stride = static_cast<std::size_t>(cairo_image_surface_get_stride(image.get()));
    const unsigned char* row = cairo_image_surface_get_data(image.get()) + y * stride;
    for (std::size_t x = 0; x < side; ++x) {
      std::uint32_t pixel = 0;
      std::memcpy(&pixel, row + 4 * x, sizeof pixel);
      for (const unsigned shift : {16U, 8U, 0U}) values.push_back(static_cast<double>(pixel >> shift & 255U));
    }
  }
  return values;
}

// The mean of each kFiner x kFiner pixels.
std::vector<double> coarser(const std::vector<double>& fine) {
  std::vector<double> mean(3 * kSide * kSide, 0.0);
  for (std::size_t y = 0; y < kFiner * kSide; ++y) {
    for (std::size_t x = 0; x < kFiner * kSide; ++x) {
      for (std::size_t c = 0; c < 3; ++c)
        mean[3 * (y / kFiner * kSide + x / kFiner) + c] += fine[3 * (y * kFiner * kSide + x) + c] / (kFiner * kFiner);
    }
  }
  return mean;
}

// Rings are 2.1 mm apart. Seen from so far that these come near to a pixel, a picture of the end of a block is what one of 64
// times as many pixels is in the mean: rings that are sampled too coarsely would show waves that are not there. Pixels of 0.3 to
// 8 mm.
TEST(ViewerWood, EndGrainShowsNoWavesThatAreNotThere) {
  // Root mean square, of 255. Rings that do not fade are 3.7 to 4.5 apart from 0.85 m on, those that do at most 2.0: they are
  // paler a little before a pixel is as wide as they are.
  constexpr double kSame = 2.5;
  for (const double distance_m : {0.55, 0.7, 0.85, 1.1, 1.5, 2.0}) {
    const std::string camera = fmt::format("0:0:{}", distance_m);
    const std::vector<double> seen = picture(camera, kSide);
    const std::vector<double> expected = coarser(picture(camera, kFiner * kSide));
    double sum = 0.0;
    for (std::size_t i = 0; i < seen.size(); ++i) sum += (seen[i] - expected[i]) * (seen[i] - expected[i]);
    EXPECT_LT(std::sqrt(sum / static_cast<double>(seen.size())), kSame) << camera;
  }
}

}  // namespace
}  // namespace springtower
