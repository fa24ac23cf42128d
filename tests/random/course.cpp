#include "tests/random/course.h"

#include "core/error.h"
#include "core/processor_time.h"
#include "solver/hand/moves.h"
#include "tests/support/prepare_and_step.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <oneapi/tbb/global_control.h>
#include <optional>

namespace springtower {
namespace {

constexpr long kFramesToAHash = 10;

std::vector<Vec3> centresOf(const Simulation& simulation) {
  std::vector<Vec3> centres;
  for (std::size_t b = 0; b < simulation.model.blockCount(); ++b) centres.push_back(centre(simulation.state.position, b));
  return centres;
}

// Names the first block with a position or velocity that is not finite; empty where all are.
std::string firstNotFinite(const Simulation& simulation) {
  for (const auto* values : {&simulation.state.position, &simulation.state.velocity}) {
    for (const auto& component : values->component) {
      for (std::size_t i = 0; i < component.size(); ++i) {
        if (std::isfinite(component[i])) continue;
        return fmt::format("block {} is not finite after frame {}", i / kCorners, simulation.frame);
      }
    }
  }
  return {};
}

double movedMost(const Simulation& simulation, const std::vector<Vec3>& start) {
  double most = 0.0;
  for (std::size_t b = 0; b < start.size(); ++b) {
    if (simulation.scene.blocks[b].fixed) continue;  // where drives have brought it
    const double moved = (centre(simulation.state.position, b) - start[b]).norm();
    most = std::max(most, moved / simulation.model.dimensions[b].minCoeff());
  }
  return most;
}

// Calls `work` and adds the processor time it takes.
template <class Work>
void timed(double& sum_s, const Work& work) {
  const double start_s = processorTime_s();
  work();
  sum_s += processorTime_s() - start_s;
}

void play(const Scene& scene, double limit_s, const CourseWatch& watch, Course& course) {
  std::optional<Simulation> made;
  std::optional<MoveRun> moves;
  timed(course.processor_s, [&] {
    made.emplace(scene);
    moves = beginMoves(*made);
  });
  Simulation& simulation = *made;
  course.tolerance_m = simulation.tolerance_m;
  const std::vector<Vec3> start = centresOf(simulation);
  if (watch.atStart) watch.atStart(simulation);
  const long frames = std::max(1L, std::lround(scene.seconds / scene.settings.frame_s));
  while (course.frames < frames) {
    if (!scene.moves.empty()) {
      timed(course.processor_s, [&] { guideHand(*moves, simulation); });
      if (moves->finished) break;
    }
    if (watch.beforeFrame) watch.beforeFrame(simulation);
    timed(course.processor_s, [&] { prepareAndStep(simulation); });
    ++course.frames;
    course.simulated_s = simulation.time_s;
    course.mostSubsteps = std::max(course.mostSubsteps, simulation.substeps);
    course.notFinite = firstNotFinite(simulation);
    if (!course.notFinite.empty()) return;
    course.movedMost = std::max(course.movedMost, movedMost(simulation, start));
    if (watch.afterFrame) watch.afterFrame(simulation);
    course.hash = stateHash(simulation);
    if (course.frames % kFramesToAHash == 0) course.hashes.push_back(course.hash);
    course.cut = course.processor_s > limit_s && course.frames < frames;
    if (course.cut) return;
  }
}

}  // namespace

Course playScene(const Scene& scene, int threads, double limit_s, const CourseWatch& watch) {
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(threads));
  Course course;
  try {
    play(scene, limit_s, watch, course);
  } catch (const StepLimitError& error) {
    course.stepLimit = error.what();
    course.simulated_s = error.time_s;
  } catch (const DivergenceError& error) {
    course.diverged = error.what();
    course.simulated_s = error.time_s;
  } catch (const InputError& error) {
    course.refused = error.what();
  }
  return course;
}

bool agree(const Course& one, const Course& other) {
  const std::size_t both = std::min(one.hashes.size(), other.hashes.size());
  if (!std::equal(one.hashes.begin(), one.hashes.begin() + static_cast<std::ptrdiff_t>(both), other.hashes.begin())) return false;
  if (one.cut && other.cut) return true;
  // What has ended by itself must have gone as far as the other was before its limit.
  if (one.cut || other.cut) return one.cut ? other.frames >= one.frames : one.frames >= other.frames;
  return one.frames == other.frames && one.hash == other.hash && one.diverged.empty() == other.diverged.empty() &&
         one.stepLimit == other.stepLimit;
}

}  // namespace springtower
