#include "apps/common/progress.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <unistd.h>

namespace springtower {
namespace {

using namespace std::chrono_literals;

constexpr std::size_t kBarWidth = 24;

}  // namespace

Progress::Progress(double total, std::string unit)
    : total_(total), unit_(std::move(unit)), terminal_(isatty(STDERR_FILENO) == 1), next_(Clock::now() + 2s) {}

void Progress::update(double done, std::string_view at) {
  if (!terminal_ || Clock::now() < next_) return;
  const double share = total_ > 0.0 ? std::clamp(done / total_, 0.0, 1.0) : 0.0;
  const auto filled = static_cast<std::size_t>(std::lround(share * static_cast<double>(kBarWidth)));
  fmt::print(stderr, "\r[{:<{}}] {:.4g} of {:.4g} {}{}{}\033[K", std::string(filled, '#'), kBarWidth, done, total_, unit_,
             at.empty() ? "" : ": ", at);
  std::fflush(stderr);
  shown_ = true;
  next_ = Clock::now() + 200ms;
}

void Progress::clear() {
  if (shown_) fmt::print(stderr, "\r\033[K");
  shown_ = false;
}

}  // namespace springtower
