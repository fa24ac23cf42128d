#include "apps/common/poses.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <iterator>
#include <ostream>

namespace springtower {

PoseWriter::PoseWriter(std::ostream& stream, double every_s, double frame_s)
    : stream_(stream), every_s_(every_s), half_s_(0.5 * frame_s) {
  stream_ << "time_s,block";
  for (std::size_t c = 0; c < kCorners; ++c) stream_ << fmt::format(",x{0},y{0},z{0}", c);
  stream_ << '\n';
}

void PoseWriter::frame(const Simulation& simulation) {
  const double late_s = simulation.time_s - written_ * every_s_;
  if (late_s < -half_s_) return;
  written_ += std::max(1.0, std::floor((late_s + half_s_) / every_s_) + 1.0);
  const ParticleArray& position = simulation.state.position;
  fmt::memory_buffer text;
  for (std::size_t b = 0; b < position.blockCount(); ++b) {
    fmt::format_to(std::back_inserter(text), "{:.10g},{}", simulation.time_s, b);
    for (std::size_t c = 0; c < kCorners; ++c) {
      const Vec3 corner = position.at(b, c);
      fmt::format_to(std::back_inserter(text), ",{:.12g},{:.12g},{:.12g}", corner.x(), corner.y(), corner.z());
    }
    text.push_back('\n');
  }
  stream_.write(text.data(), static_cast<std::streamsize>(text.size()));
}

}  // namespace springtower
