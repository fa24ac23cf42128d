#pragma once

#include <stdexcept>
#include <string>

namespace springtower {

/// Bad input: a file, key or argument. The message is one line that names it, says what is expected and what it got. Programs
/// print it and end with exit code 2.
struct InputError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// The simulation diverged: which block, when, and why. Programs print it and end with exit code 3.
struct DivergenceError : std::runtime_error {
  DivergenceError(const std::string& message, int divergedBlock, double divergedTime_s)
      : std::runtime_error(message), block(divergedBlock), time_s(divergedTime_s) {}
  int block;      ///< the block, counted from 0
  double time_s;  ///< simulated time, s
};

/// An explicit method would need more steps for the coming frame than `kMaxExplicitSubsteps`: which block is the stiffest for its
/// mass, when, and how many. Its island has not been stepped; other islands of the frame may have been, as where one diverges. To
/// users it is a simulation that fails, as one that diverges.
struct StepLimitError : DivergenceError {
  using DivergenceError::DivergenceError;
};

}  // namespace springtower
