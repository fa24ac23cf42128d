#include "tests/apps/viewer/app/random_user.h"

#include "apps/viewer/input/controls.h"

#include <algorithm>

namespace springtower {
namespace {

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
    case 10: {
      const double azimuth = 0.05 * (dice.below(9) - 4);
      return lookRound(controls, azimuth, 0.05 * (dice.below(9) - 4));
    }
    default:
      viewer.limit_n = 0.5 + 19.5 * dice.share();
      return;
  }
}

}  // namespace

void actAtRandom(Viewer& viewer, Dice& dice) {
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
    freeKeyChanged(controls, viewer.session, dice.happens(0.4));
  } else {
    pressKey(viewer, dice);
    if (viewer.paused && !viewer.once && dice.happens(0.8)) viewer.paused = false;
  }
}

Viewer randomViewer(const std::string& scene, int players, Method method) {
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

void playAtRandom(Viewer& viewer, double seconds, Dice& dice) {
  const double frame_s = viewer.session.scene.settings.frame_s;
  for (int i = 0; i < seconds / frame_s; ++i) {
    actAtRandom(viewer, dice);
    viewer.session.frame_ms = 0.0;  // what a slow machine leaves out would not repeat
    advance(viewer, frame_s);
    pictureOf(viewer);
  }
}

}  // namespace springtower
