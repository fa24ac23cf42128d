#pragma once

#include "core/scene/scene.h"
#include "solver/world/simulation.h"

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace springtower {

/// How one run of a scene went.
struct Course {
  std::vector<std::uint64_t> hashes;  ///< of the state after every tenth frame
  std::uint64_t hash = 0;             ///< after the last frame
  long frames = 0;
  double simulated_s = 0.0;
  double processor_s = 0.0;  ///< setting up and stepping
  int mostSubsteps = 0;
  double tolerance_m = 0.0;
  double movedMost = 0.0;  ///< farthest that the centre of a block was from its start at the end of a frame, in its least sides
  bool cut = false;        ///< the limit came before the end
  std::string diverged;    ///< message of DivergenceError
  std::string stepLimit;   ///< message of StepLimitError
  std::string notFinite;   ///< the block and the frame
  std::string refused;     ///< message of InputError
};

/// What looks at a run.
struct CourseWatch {
  std::function<void(const Simulation&)> atStart = {};
  std::function<void(const Simulation&)> beforeFrame = {};  ///< hand and forces are those of the coming frame
  std::function<void(const Simulation&)> afterFrame = {};
};

/// Plays a scene on so many threads until its seconds or its moves are over, or the processor time. What is wrong ends the run
/// and is in the course.
Course playScene(const Scene& scene, int threads, double limit_s, const CourseWatch& watch = {});

/// Whether two runs of one scene agree: in the hashes of their states as far as both went, and in that both diverged or none, and
/// both ended at the limit of an explicit method's steps or none. Of one whose processor time was over the end is not known: it
/// agrees with one that went at least as far.
bool agree(const Course& one, const Course& other);

}  // namespace springtower
