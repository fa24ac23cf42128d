// Scenes in which everything that runs on many threads does so, on four threads also where the machine has fewer cores, and a
// hash of the state of each: for ThreadSanitizer (`.ci/long threads`), and to compare oneTBB with core/plain_threads.h.
//   thread_scenes [NAME...]   plays these, or all
#include "core/error.h"
#include "core/method.h"
#include "scenarios/random_scene.h"
#include "scenarios/towers.h"
#include "scenarios/walls.h"
#include "solver/frame/prepare.h"
#include "solver/hand/grip.h"
#include "solver/hand/played_frame.h"
#include "solver/world/engine.h"
#include "solver/world/simulation.h"
#include "tests/support/two_walls.h"
#include "tests/support/uneven_tower.h"

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <exception>
#include <memory>
#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/task_arena.h>
#include <string>
#include <vector>

namespace springtower {
namespace {

constexpr int kThreads = 4;
constexpr std::uint64_t kRandomScenes = 12;
constexpr int kRandomFrames = 12;

struct ThreadScene {
  std::string name;
  int frames;
  Scene scene;
  BlockId pulled = kFloor;  // by a hand
  bool goesBack = false;    // the second half of the frames is played once more, from a snapshot
};

Scene with(Scene scene, Method method) {
  scene.settings.method = method;
  return scene;
}

// A wide island, whose kernels take ranges, beside narrow ones: both kinds of parallelism at once, one within the other.
Scene wallBesideTowers() {
  Scene scene = grid(unevenTower(6), 2, 2, kTowerSpacing_m);
  for (BlockSpec block : wallScene(24, 16).blocks) {
    block.centre.y() += 2.0;
    block.row = -1;
    scene.blocks.push_back(block);
  }
  return scene;
}

// The lowest course moves to and fro.
Scene shaken(Scene scene) {
  for (int block = 0; block < 8; ++block) {
    scene.blocks[static_cast<std::size_t>(block)].fixed = true;
    scene.drives.push_back({.block = block, .amplitude = Vec3(0.0, 5e-4, 0.0), .frequency_hz = 2.0});
  }
  return scene;
}

// What prepare() finds, what changes from frame to frame, what flies, slides, falls and goes to sleep.
std::vector<ThreadScene> threadScenes() {
  Scene landing = pileScene(3, {.fall_m = 0.01});
  landing.settings.tolerance_m = 2e-4;
  std::vector<ThreadScene> all = {
      {"wall", 12, awake(wallScene(24, 16))},
      {"wall-sleeps", 45, wallScene(24, 16)},
      {"wall-sways", 6, awake(swaying(wallScene(24, 16), 0.3, 2.0))},
      {"walls-sway", 6, awake(swaying(twoWalls(), 0.3, 2.0))},
      {"wall-explicit", 1, with(awake(wallScene(24, 12)), Method::semiImplicitEuler)},
      {"pyramid", 12, awake(cubePyramidScene(24))},
      {"bricks", 6, awake(brickPyramidScene(24))},
      {"towers", 8, awake(squareOf(unevenTower(18), 16))},
      {"wall-beside-towers", 8, awake(wallBesideTowers())},
      {"pile-lands", 3, landing},
      {"collapse", 60, leaning(towerScene(18), kTopplingTilt_deg)},
      {"collapses", 50, leaning(grid(towerScene(4), 4, 2, kTowerSpacing_m), 30.0)},
      {"rigid", 6, with(awake(squareOf(unevenTower(18), 6)), Method::rigidPgs)},
      {"rigid-wide", 4, with(awake(wallScene(24, 16)), Method::rigidPgs)},
      {"report", 2, with(awake(squareOf(unevenTower(6), 4)), Method::report)},
      {"xpbd", 6, with(awake(squareOf(unevenTower(6), 4)), Method::xpbd)},
      {"rigid-lcp", 2, with(awake(squareOf(towerScene(2), 4)), Method::rigidLcp)},
      {"wall-euler", 6, with(awake(wallScene(24, 16)), Method::implicitEuler)},
      {"wall-eigen", 3, with(awake(wallScene(24, 16)), Method::implicitEigen)},
      {"midpoint", 1, with(awake(squareOf(towerScene(3), 4)), Method::midpoint)},
      {"runge-kutta-4", 1, with(awake(squareOf(towerScene(3), 4)), Method::rungeKutta4)},
      {"wall-shaken", 8, awake(shaken(wallScene(24, 16)))},
      {"wall-pulled", 8, awake(wallScene(24, 16)), blockId(100)},
      {"wall-again", 6, awake(swaying(wallScene(24, 16), 0.3, 2.0)), kFloor, true},
  };
  for (std::uint64_t seed = 1; seed <= kRandomScenes; ++seed)
    all.push_back({"random-" + std::to_string(seed), kRandomFrames, with(randomScene(seed).scene, Method::implicit)});
  return all;
}

// Hash of the state in the end, also where the scene diverges before.
std::uint64_t hashOf(const ThreadScene& played) {
  Simulation simulation(played.scene);
  PrepareOptions options;
  std::uint64_t calls = 0;  // goesOn is called by whatever thread, one call at a time
  options.goesOn = [&](const PrepareProgress&) { return ++calls > 0; };
  std::vector<ContactForce> contacts;
  Grip grip;
  Hand hand;
  if (played.pulled != kFloor) hand = handOn(simulation, played.pulled);
  hand.velocity = Vec3(0.0, 0.04, 0.0);
  const auto play = [&](int frames) {
    for (int frame = 0; frame < frames; ++frame) {
      hand.place += played.scene.settings.frame_s * hand.velocity;
      stepPlayed(hand, grip, contacts, simulation);
    }
  };
  try {
    prepare(simulation, options);
    contacts = contactForces(simulation);
    play(played.frames / 2);
    const std::shared_ptr<const Snapshot> half = takeSnapshot(simulation);
    play(played.frames - played.frames / 2);
    if (played.goesBack) {
      restoreSnapshot(simulation, *half);
      play(played.frames - played.frames / 2);
    }
  } catch (const DivergenceError& error) {
    std::printf("%s: %s\n", played.name.c_str(), error.what());
  }
  return stateHash(simulation);
}

int play(const std::vector<std::string>& names) {
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, kThreads);
  tbb::task_arena arena(kThreads);
  int played = 0;
  for (const ThreadScene& scene : threadScenes()) {
    if (!names.empty() && std::find(names.begin(), names.end(), scene.name) == names.end()) continue;
    const std::uint64_t hash = arena.execute([&] { return hashOf(scene); });
    std::printf("%-20s %4zu blocks %3d frames %016llx\n", scene.name.c_str(), scene.scene.blocks.size(), scene.frames,
                static_cast<unsigned long long>(hash));
    std::fflush(stdout);
    ++played;
  }
  if (played > 0) return 0;
  std::fprintf(stderr, "thread_scenes: expected names of scenes as it prints them without arguments, got others\n");
  return 2;
}

}  // namespace
}  // namespace springtower

int main(int argc, char** argv) {
  try {
    return springtower::play(std::vector<std::string>(argv + 1, argv + argc));
  } catch (const std::exception& error) {
    std::fprintf(stderr, "thread_scenes: %s\n", error.what());
    return 1;
  }
}
