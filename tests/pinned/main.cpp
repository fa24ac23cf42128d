// springtower_pinned_tests                 compares every scene with its pins
// springtower_pinned_tests --update FILE   writes the pins (tests/data/pinned.json) as the engine has them now
#include "core/processor_time.h"
#include "tests/pinned/pin.h"

#include <cstdio>
#include <cstring>
#include <exception>
#include <fmt/format.h>
#include <gtest/gtest.h>

namespace {

// Plays every scene on one thread, says what it costs and writes its pins.
void updatePins(const char* path) {
  springtower::Pins pins;
  const double start_s = springtower::processorTime_s();
  for (const springtower::PinnedScene& scene : springtower::pinnedScenes()) {
    const double sceneStart_s = springtower::processorTime_s();
    pins[scene.name] = springtower::pinOf(scene, 1);
    fmt::print("{:28} {:5} frames {:7.2f} s\n", scene.name, scene.frames, springtower::processorTime_s() - sceneStart_s);
  }
  fmt::print("{} scenes, {:.1f} s of processor time\n", pins.size(), springtower::processorTime_s() - start_s);
  springtower::writePins(path, pins);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc == 3 && std::strcmp(argv[1], "--update") == 0) {
    try {
      updatePins(argv[2]);
      return 0;
    } catch (const std::exception& error) {
      std::fprintf(stderr, "springtower_pinned_tests: %s\n", error.what());
      return 2;
    }
  }
  ::testing::InitGoogleTest(&argc, argv);
  if (argc == 1) return RUN_ALL_TESTS();
  std::fprintf(stderr, "springtower_pinned_tests: expected --update FILE or the options of GoogleTest, got '%s'\n", argv[1]);
  return 2;
}
