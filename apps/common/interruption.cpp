#include "apps/common/interruption.h"

#include <atomic>
#include <csignal>
#include <initializer_list>
#include <unistd.h>

namespace springtower {
namespace {

constexpr int kSignalExit = 128;  // added to the signal's number, as shells do

std::atomic<int> gSignal{0};
static_assert(std::atomic<int>::is_always_lock_free, "a handler may touch nothing else");

void onSignal(int signal) {
  if (gSignal.exchange(signal) != 0) _exit(kSignalExit + signal);
}

}  // namespace

void noteInterruption() {
  for (const int signal : {SIGINT, SIGTERM}) {
    struct sigaction before {};
    if (sigaction(signal, nullptr, &before) == 0 && before.sa_handler == SIG_IGN) continue;
    struct sigaction action {};
    action.sa_handler = onSignal;
    sigemptyset(&action.sa_mask);
    action.sa_flags = SA_RESTART;  // what is being written to a pipe is written whole
    sigaction(signal, &action, nullptr);
  }
}

bool interrupted() {
  return gSignal.load(std::memory_order_relaxed) != 0;
}

int interruptionExitCode() {
  const int signal = gSignal.load();
  return signal == 0 ? 0 : kSignalExit + signal;
}

void endIfInterrupted() {
  if (interrupted()) throw Interrupted{};
}

}  // namespace springtower
