#include "apps/viewer/input/controls.h"

#include "apps/viewer/input/view.h"
#include "core/limits.h"

#include <Eigen/Geometry>
#include <cmath>

namespace springtower {
namespace {

constexpr double kOrbitPerPixel = 0.006;  // rad

bool holds(const Controls& controls) {
  return controls.hand.block != kFloor;
}

bool isBusy(const Controls& controls) {
  return holds(controls) || controls.guide.lead != Lead::none;
}

// Whether the mouse moves the block, or is about to.
bool followsMouse(const Guide& guide) {
  return guide.lead == Lead::selected || guide.lead == Lead::pulling || guide.lead == Lead::carrying ||
         guide.lead == Lead::freely;
}

void take(Controls& controls, const Session& session) {
  const std::optional<Pick> pick =
      pickBlock(session.simulation.state.position, rayThrough(controls.camera, controls.viewport, controls.x, controls.y));
  if (isBusy(controls)) {  // it lays down the last block, which can be taken again
    if (pick && pick->block == controls.guide.block) carryAgain(controls.guide, controls.hand);
    return;
  }
  if (!pick || session.simulation.model.isFixed(index(pick->block)) || !mayTake(session.game, pick->block)) return;
  select(controls.guide, pick->block);
  controls.hover.reset();
  if (!controls.free) return;
  controls.hand = handOn(session.simulation, pick->block, controls.hand.limit_n);
  setFree(controls.guide, controls.hand);
}

// Moves the hand in the plane of the screen, or along the view.
void moveFreely(Controls& controls, double dx, double dy) {
  const CameraFrame frame = cameraFrame(controls.camera);
  const double scale = metresPerPixel(controls.camera, controls.viewport, controls.hand.place);
  if (controls.right) {
    controls.hand.place += scale * dy * frame.back;
  } else {
    controls.hand.place += scale * (dx * frame.right - dy * frame.up);
  }
  // What is drawn away from the camera goes ever faster; a recording holds no places beyond these.
  controls.hand.place = controls.hand.place.cwiseMax(kPlaceRange.least).cwiseMin(kPlaceRange.most);
}

}  // namespace

void pointerMoved(Controls& controls, const Session& session, double x, double y) {
  const double dx = x - controls.x;
  const double dy = y - controls.y;
  controls.x = x;
  controls.y = y;
  const bool dragging = controls.left || controls.right;
  if (controls.middle || (dragging && !followsMouse(controls.guide))) {
    lookRound(controls, -kOrbitPerPixel * dx, kOrbitPerPixel * dy);
  } else if (dragging && controls.guide.lead == Lead::freely) {
    moveFreely(controls, dx, dy);
  } else if (dragging) {
    dragBy(controls.guide, controls.hand, session, controls.camera, controls.viewport, {dx, dy});
  }
  updateHover(controls, session);
}

void buttonChanged(Controls& controls, const Session& session, Button button, bool pressed) {
  bool& state = button == Button::left ? controls.left : button == Button::right ? controls.right : controls.middle;
  const bool first = !controls.left && !controls.right;
  state = pressed;
  if (button == Button::middle) return;
  if (pressed && first) take(controls, session);
  if (!controls.left && !controls.right) release(controls.guide, controls.hand);
}

void freeKeyChanged(Controls& controls, const Session& session, bool pressed) {
  controls.free = pressed;
  if (pressed) {
    setFree(controls.guide, controls.hand);
  } else {
    guideAgain(controls.guide, controls.hand, session);
  }
}

void wheelTurned(Controls& controls, double steps) {
  if (!holds(controls)) {
    comeNearer(controls, steps);
  } else if (controls.guide.lead == Lead::freely) {
    turnHand(controls, TurnAxis::vertical, kWheelTurn * steps);
  } else {
    turnHand(controls, TurnAxis::vertical, steps);
  }
}

void turnHand(Controls& controls, TurnAxis axis, double angle) {
  if (!holds(controls)) return;
  if (controls.guide.lead != Lead::freely) {
    if (axis == TurnAxis::vertical && angle != 0.0) turnQuarters(controls.guide, std::copysign(1.0, angle));
    return;
  }
  const CameraFrame frame = cameraFrame(controls.camera);
  const Vec3 about = axis == TurnAxis::vertical ? Vec3(Vec3::UnitZ()) : axis == TurnAxis::right ? frame.right : frame.back;
  controls.hand.turn = (Eigen::AngleAxisd(angle, about) * controls.hand.turn).normalized();
}

void lookRound(Controls& controls, double azimuth, double elevation) {
  orbit(controls.camera, azimuth, elevation);
  controls.looked = true;
  if (!holds(controls)) controls.home.reset();
}

void comeNearer(Controls& controls, double steps) {
  zoom(controls.camera, steps);
  if (controls.home) controls.home->distance = controls.camera.distance;
}

void leadHand(Controls& controls, const Session& session, double limit_n) {
  controls.hand.limit_n = limit_n;
  leadHand(controls.guide, controls.hand, session, controls.camera, controls.viewport, limit_n);
}

void moveCamera(Controls& controls, const Session& session, double elapsed_s) {
  const bool follows = holds(controls) && controls.guide.lead != Lead::freely;
  if (follows && !controls.home) {
    controls.home = controls.camera;
    controls.looked = false;
  }
  if (!controls.home) return;
  Camera goal = *controls.home;
  if (follows) {
    const bool carried = controls.hand.line.isZero(0.0);
    const double azimuth = carried ? controls.camera.azimuth : squareTo(controls.camera, controls.hand.line);
    goal = viewOfHeld(*controls.home, azimuth, centre(session.simulation.state.position, index(controls.hand.block)), carried);
  }
  if (controls.looked) {  // the user's own direction stays
    goal.azimuth = controls.camera.azimuth;
    goal.elevation = controls.camera.elevation;
  }
  if (holds(controls) && !follows) return;
  ease(controls.camera, goal, elapsed_s);
  if (!follows && showsTheSame(controls.camera, goal)) controls.home.reset();
}

void letGo(Controls& controls) {
  controls.hand.block = kFloor;
  controls.guide = {};
}

void updateHover(Controls& controls, const Session& session) {
  controls.hover.reset();
  if (isBusy(controls) || controls.middle || controls.left || controls.right) return;
  controls.hover =
      pickBlock(session.simulation.state.position, rayThrough(controls.camera, controls.viewport, controls.x, controls.y));
}

}  // namespace springtower
