#pragma once

#include "core/scene/scene.h"
#include "tests/random/record.h"

#include <functional>

namespace springtower {

/// How a scene is judged.
struct JudgeOptions {
  double limit_s = 1.0;        ///< s, processor time of each of the runs below; a run ends with the frame in which it is over
  bool compareThreads = true;  ///< a second run on two threads, of a quarter of that time
  bool compareSleep = true;    ///< a third with sleep where there was none, and without where there was
  std::function<void(double)> beforeRun = {};        ///< called with the limit of the run that begins
  std::function<void(const Record&)> afterRun = {};  ///< with what is known by then
};

/// Plays a scene for its `seconds`, or until its moves are done, and measures what must hold in every scene: it does not diverge,
/// stays finite, gains no energy, keeps momentum where there is no gravity and no floor, penetrates little, takes less time than
/// it simulates, and is the same on two threads and with sleep and without. What is wrong is in the record; nothing is thrown but
/// std::bad_alloc. Precondition: checkScene accepts the scene.
Record judgeScene(const Scene& scene, const JudgeOptions& options);

}  // namespace springtower
