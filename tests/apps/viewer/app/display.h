#pragma once

#include "tests/support/program.h"

#include <string>
#include <string_view>
#include <vector>

namespace springtower {

/// A program that runs beside the test; it is ended with the object.
class Background {
 public:
  /// Starts a program: a name of this build's folder bin, or a path. `variables` ("NAME=value") are put over the environment;
  /// standard output and errors go into the file `output`. Throws std::runtime_error.
  Background(const std::string& program, const std::vector<std::string>& arguments, const std::vector<std::string>& variables,
             const std::string& output);
  Background(const Background&) = delete;
  Background& operator=(const Background&) = delete;
  ~Background();
  /// Whether it still runs.
  [[nodiscard]] bool runs();
  /// Waits for its end; returns the exit code, minus the signal that ended it, or -1000 when it still runs after the time.
  int wait(double seconds);
  /// Sends a signal. Precondition: it runs.
  void send(int signal) const;

 private:
  int process_ = -1;
  int exitCode_ = -1000;
};

/// A display of its own, drawn in memory, with a mouse and a keyboard.
class Display {
 public:
  /// Starts Xvfb. Throws std::runtime_error when it does not answer.
  Display(int width, int height);
  [[nodiscard]] std::string variable() const { return "DISPLAY=" + name_; }
  /// Runs a script of xdotool, a command a line. Throws std::runtime_error when it fails.
  void act(std::string_view script) const;

 private:
  ScratchFolder scratch_;
  Background server_;
  std::string name_;
};

/// Waits until a condition holds, for at most this long; returns whether it does.
template <class Condition>
bool waitUntil(double seconds, const Condition& condition);

/// Lets time pass.
void sleepFor(double seconds);

template <class Condition>
bool waitUntil(double seconds, const Condition& condition) {
  constexpr double kBetween_s = 0.01;
  for (double waited = 0.0; waited < seconds; waited += kBetween_s) {
    if (condition()) return true;
    sleepFor(kBetween_s);
  }
  return condition();
}

}  // namespace springtower
