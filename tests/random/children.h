#pragma once

#include "scenarios/random_scene.h"
#include "tests/random/judge.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>

namespace springtower {

/// How scenes are judged in processes of their own, so that one that crashes or hangs is a result and not the end.
struct ChildOptions {
  JudgeOptions judge;
  bool withProgram = false;  ///< also runs `springtower run` on the scene as a file
};

/// One scene to judge.
struct ChildTask {
  RandomScene random;
  std::optional<std::uint64_t> seed;
};

/// Judges scenes in child processes, at most `jobs` at once. `next` gives the next one, nothing when there are no more; `done`
/// is called with each record when its child has ended. A child may use processor time up to the limit of each run and a second
/// more, and 4 GB of addresses (not under the address sanitizer, whose shadow needs more). Precondition: the caller has one
/// thread: children are forks. Throws std::runtime_error where the system gives no process.
void judgeInChildren(const ChildOptions& options, std::size_t jobs, const std::function<std::optional<ChildTask>()>& next,
                     const std::function<void(const ChildTask&, const Record&)>& done);

/// One scene.
Record judgeInChild(const RandomScene& random, const ChildOptions& options);

}  // namespace springtower
