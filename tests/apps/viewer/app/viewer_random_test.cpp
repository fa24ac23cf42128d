// A user who does anything at random: on the viewer itself frame by frame, where all repeats, and with mouse and keys on the real
// program.
#include "apps/viewer/view/state.h"
#include "core/random.h"
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

/// Draws what the user does next.
class Dice {
 public:
  explicit Dice(std::uint64_t seed) : random_(seed, 1) {}
  double share() { return random_.uniform(); }
  int below(int n) { return static_cast<int>(n * share()); }
  bool happens(double probability) { return share() < probability; }

 private:
  RandomStream random_;
};

// One of the keys that the window handles, or one of its panel's switches.
void pressKey(Viewer& viewer, Dice& dice) {
  Controls& controls = viewer.controls;
  switch (dice.below(12)) {
    case 0:
      viewer.paused = !viewer.paused;
      return;
    case 1:
      viewer.paused = viewer.once = true;
      return;
    case 2:
      return travel(viewer, viewer.session.frame - std::min<std::uint64_t>(viewer.session.frame, 1));
    case 3:
      return travel(viewer, viewer.session.frame + 1);
    case 4:
      return undo(viewer);
    case 5:
      if (dice.happens(0.3)) restart(viewer, viewer.choice);
      return;
    case 6:
      viewer.overlay = static_cast<Overlay>(dice.below(static_cast<int>(kOverlays)));
      return;
    case 7:
      viewer.arrows = !viewer.arrows;
      return;
    case 8:
      return turnHand(controls, TurnAxis::view, kKeyTurn * (dice.below(9) - 4));
    case 9:
      return turnHand(controls, TurnAxis::right, kKeyTurn * (dice.below(9) - 4));
    case 10:
      return orbit(controls.camera, 0.05 * (dice.below(9) - 4), 0.05 * (dice.below(9) - 4));
    default:
      viewer.limit_n = 0.5 + 19.5 * dice.share();
      return;
  }
}

void act(Viewer& viewer, Dice& dice) {
  Controls& controls = viewer.controls;
  const Viewport& viewport = controls.viewport;
  const double what = dice.share();
  if (what < 0.70) {
    // Mostly over the tower, where something happens.
    const double x = viewport.width * (0.25 + 0.5 * dice.share());
    pointerMoved(controls, viewer.session, x, viewport.height * dice.share());
  } else if (what < 0.90) {
    const Button button = dice.happens(0.6) ? Button::left : dice.happens(0.75) ? Button::right : Button::middle;
    buttonChanged(controls, viewer.session, button, dice.happens(0.6));
  } else if (what < 0.95) {
    wheelTurned(controls, dice.below(7) - 3);
  } else if (what < 0.97) {
    controls.look = dice.happens(0.4);
  } else {
    pressKey(viewer, dice);
    if (viewer.paused && !viewer.once && dice.happens(0.8)) viewer.paused = false;
  }
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

Viewer randomViewer(const std::string& scene, int players, Method method = Method::semiImplicitEuler) {
  SceneChoice choice;
  choice.name = scene;
  choice.players = players;
  choice.options.heightsSigma_m = kUsualSigma_m;
  Tuning tuning = tuningOf(sceneOf(choice));
  tuning.method = method;
  Viewer viewer(choice, tuning);
  viewer.watch.measures = true;
  return viewer;
}

void play(Viewer& viewer, double seconds, Dice& dice) {
  const double frame_s = viewer.session.scene.settings.frame_s;
  for (int i = 0; i < seconds / frame_s; ++i) {
    act(viewer, dice);
    viewer.session.frame_ms = 0.0;  // what a slow machine leaves out would not repeat
    advance(viewer, frame_s);
    pictureOf(viewer);
  }
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
  play(viewer, seconds, dice);
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
  play(viewer, 20.0, dice);
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
    play(viewer, 0.25, dice);
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
    play(viewer, 3.0, dice);
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
      script += fmt::format("mousemove {} {}\n", kWindowWidth / 4 + dice.below(kWindowWidth / 2), dice.below(kWindowHeight));
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
  Window window({"--scene", "tower:3"});
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
