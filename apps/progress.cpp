#include "apps/progress.h"

#include <fmt/format.h>
#include <unistd.h>

namespace springtower {
namespace {

using namespace std::chrono_literals;

}  // namespace

Progress::Progress(double total, std::string unit)
    : total_(total), unit_(std::move(unit)), terminal_(isatty(STDERR_FILENO) == 1), next_(Clock::now() + 2s) {}

void Progress::update(double done) {
  if (!terminal_ || Clock::now() < next_) return;
  fmt::print(stderr, "\r{:.4g} of {:.4g} {}   ", done, total_, unit_);
  std::fflush(stderr);
  shown_ = true;
  next_ = Clock::now() + 200ms;
}

void Progress::clear() {
  if (shown_) fmt::print(stderr, "\r\033[K");
  shown_ = false;
}

}  // namespace springtower
