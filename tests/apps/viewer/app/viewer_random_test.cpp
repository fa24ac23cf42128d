// A user who does anything at random: on the viewer itself frame by frame, where all repeats, and with mouse and keys on the real
// program.
#include "tests/apps/viewer/app/random_user.h"
#include "tests/apps/viewer/app/viewer_window.h"

#include <array>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <malloc.h>

namespace springtower {
namespace {

// SPRINGTOWER_RANDOM_SECONDS: how long, if not as given here (the target viewer_random plays for ten minutes).
double secondsOr(double usual) {
  const char* given = std::getenv("SPRINGTOWER_RANDOM_SECONDS");
  return given == nullptr ? usual : std::atof(given);
}

// What a user who changes the physics all the time may do.
void retune(Viewer& viewer, Dice& dice) {
  constexpr std::array kMethods = {Method::implicit, Method::semiImplicitEuler, Method::midpoint, Method::rungeKutta4,
                                   Method::report};
  constexpr std::array kSleeps = {Sleep::off, Sleep::on, Sleep::report};
  viewer.tuning.method = kMethods[static_cast<std::size_t>(dice.below(static_cast<int>(kMethods.size())))];
  viewer.tuning.sleep = kSleeps[static_cast<std::size_t>(dice.below(static_cast<int>(kSleeps.size())))];
  viewer.tuning.friction = dice.share();
  viewer.tuning.tolerance_m = 2e-5 * std::pow(50.0, dice.share());
}

bool finite(const ParticleArray& position) {
  for (const auto& values : position.component) {
    for (const double value : values) {
      if (!std::isfinite(value)) return false;
    }
  }
  return true;
}

class ViewerRandomMinute : public testing::TestWithParam<Method> {};
INSTANTIATE_TEST_SUITE_P(Methods, ViewerRandomMinute, testing::Values(Method::semiImplicitEuler, Method::implicit));

TEST_P(ViewerRandomMinute, BreaksNothing) {
  const double seconds = secondsOr(60.0);
  Viewer viewer = randomViewer("tower:6", 0, GetParam());
  Dice dice(1);
  playAtRandom(viewer, seconds, dice);
  RecordProperty("frames", std::to_string(viewer.watch.frames));
  RecordProperty("max_penetration_mm", std::to_string(1e3 * viewer.watch.deepest.depth));
  EXPECT_TRUE(finite(viewer.session.simulation.state.position));
  EXPECT_EQ(viewer.watch.failures, 0);
  EXPECT_GT(static_cast<double>(viewer.watch.frames), 30.0 * seconds);
  EXPECT_GT(viewer.watch.mostMove_m, 0.05);  // something did happen
  EXPECT_LT(viewer.watch.deepest.depth, 1e-3) << "at " << viewer.watch.deepestTime_s << " s of the run it happened in";
}

TEST(ViewerRandom, AGameAtRandomBreaksNothing) {
  Viewer viewer = randomViewer("tower:4", 2);
  Dice dice(2);
  playAtRandom(viewer, 20.0, dice);
  EXPECT_TRUE(finite(viewer.session.simulation.state.position));
  EXPECT_EQ(viewer.watch.failures, 0);
  EXPECT_LT(viewer.watch.deepest.depth, 1e-3) << viewer.watch.deepestTime_s;
}

// Any method, stiffness and friction from one moment to the next: it may end in a divergence that is named, and goes on from a
// reset.
TEST(ViewerRandom, PhysicsChangedAtRandomIsAnsweredOrNamed) {
  Viewer viewer = randomViewer("tower:3", 0);
  Dice dice(3);
  for (int i = 0; i < 20; ++i) {
    retune(viewer, dice);
    playAtRandom(viewer, 0.25, dice);
    if (!viewer.session.failure.empty()) {
      EXPECT_FALSE(viewer.message.empty());
      restart(viewer, viewer.choice);
      viewer.paused = false;
    }
    ASSERT_TRUE(finite(viewer.session.simulation.state.position)) << i;
  }
  EXPECT_GT(viewer.watch.frames, 100U);
}

// The first play fills what is kept for good, as pools of threads; the second must give all back.
TEST(ViewerRandom, AViewerThatWasPlayedLeavesNoMemoryBehind) {
  const auto once = [] {
    Viewer viewer = randomViewer("tower:3", 1);
    Dice dice(4);
    playAtRandom(viewer, 3.0, dice);
    return viewer.session.log.size();
  };
  EXPECT_GT(once(), 0U);
  const auto before = static_cast<double>(mallinfo2().uordblks);
  once();
  EXPECT_LT(static_cast<double>(mallinfo2().uordblks), before + 65536.0);
}

// A script of random mouse and key events.
std::string randomScript(Dice& dice, int events) {
  constexpr std::array kKeys = {"space",    "n", "t",    "o",     "f",  "q",    "e",     "w",     "s",           "a",
                                "d",        "r", "Left", "Right", "Up", "Down", "equal", "minus", "bracketleft", "bracketright",
                                "BackSpace"};
  std::string script;
  for (int i = 0; i < events; ++i) {
    const double what = dice.share();
    if (what < 0.70) {
      const int x = kWindowWidth / 4 + dice.below(kWindowWidth / 2);
      script += fmt::format("mousemove {} {}\n", x, dice.below(kWindowHeight));
    } else if (what < 0.90) {
      script += fmt::format("{} {}\n", dice.happens(0.6) ? "mousedown" : "mouseup", dice.happens(0.6) ? 1 : 3);
    } else if (what < 0.95) {
      script += fmt::format("click {}\n", 4 + dice.below(2));
    } else if (what < 0.97) {
      script += fmt::format("{} shift\n", dice.happens(0.4) ? "keydown" : "keyup");
    } else {
      const std::string key = kKeys[static_cast<std::size_t>(dice.below(static_cast<int>(kKeys.size())))];
      script += "key " + key + "\n";
      const bool pauses = key == "n" || key == "space" || key.starts_with("bracket");
      if (pauses) script += "sleep 0.1\nkey space\n";
    }
    script += "sleep 0.02\n";
  }
  return script;
}

TEST(ViewerRandom, RandomMouseAndKeysDoNotEndTheProgram) {
  Window window({"--scene", "tower:6", "--no-panels"});
  Dice dice(5);
  const double seconds = secondsOr(8.0);
  const auto start = std::chrono::steady_clock::now();
  while (std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count() < seconds) {
    window.act(randomScript(dice, 60));
    ASSERT_TRUE(window.runs()) << window.log();
  }
  window.act("keyup shift\nmouseup 1\nmouseup 3\n");
  EXPECT_EQ(window.close(), 0) << window.log();
  const auto report = window.report();
  EXPECT_TRUE(report.at("finite").get<bool>());
  EXPECT_EQ(report.at("divergences").get<int>(), 0);
  EXPECT_LT(report.at("max_penetration_all_mm").get<double>(), 1.0) << report.dump(2);
  EXPECT_GT(report.at("frames_stepped").get<double>(), 0.0);
}

// Panels change the physics to anything they offer, so only the program is judged here, not what becomes of the tower.
TEST(ViewerRandom, RandomClicksOnThePanelsDoNotEndTheProgram) {
  Window window({"--scene", "tower:3", "--mode", "lab"});
  Dice dice(6);
  std::string script;
  for (int i = 0; i < 80; ++i) {
    const int x = dice.below(360);
    script += fmt::format("mousemove {} {}\n{} 1\n", x, dice.below(kWindowHeight), dice.happens(0.7) ? "click" : "mousedown");
    if (i % 7 == 0) script += "mouseup 1\nclick 5\n";
    script += "sleep 0.02\n";
  }
  window.act(script + "mouseup 1\n");
  EXPECT_TRUE(window.runs()) << window.log();
  EXPECT_EQ(window.close(), 0) << window.log();
}

}  // namespace
}  // namespace springtower
