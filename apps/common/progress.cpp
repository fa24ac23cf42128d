#include "apps/common/progress.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fmt/format.h>
#include <unistd.h>

namespace springtower {
namespace {

using namespace std::chrono_literals;

constexpr std::size_t kBarWidth = 24;

// A terminal that is gone takes no bar, which is no reason to end the work.
void show(const std::string& text) {
  std::fwrite(text.data(), 1, text.size(), stderr);
  std::fflush(stderr);
}

}  // namespace

Progress::Progress(double total, std::string unit)
    : total_(total), unit_(std::move(unit)), terminal_(isatty(STDERR_FILENO) == 1), next_(Clock::now() + 2s) {}

void Progress::update(double done, std::string_view at) {
  if (!terminal_ || Clock::now() < next_) return;
  next_ = Clock::now() + 200ms;
  const std::string where = at.empty() ? "" : fmt::format(": {}", at);
  shown_ = true;
  if (total_ <= 0.0) return show(fmt::format("\r{:.4g} {}{}\033[K", done, unit_, where));
  const double share = std::clamp(done / total_, 0.0, 1.0);
  const auto filled = static_cast<std::size_t>(std::lround(share * static_cast<double>(kBarWidth)));
  show(fmt::format("\r[{:<{}}] {:.4g} of {:.4g} {}{}\033[K", std::string(filled, '#'), kBarWidth, done, total_, unit_, where));
}

void Progress::clear() {
  if (shown_) show("\r\033[K");
  shown_ = false;
}

}  // namespace springtower
