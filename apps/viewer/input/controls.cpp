#include "apps/viewer/input/controls.h"

#include "core/limits.h"

namespace springtower {
namespace {

constexpr double kOrbitPerPixel = 0.006;  // rad

bool holds(const Controls& controls) {
  return controls.hand.block != kFloor;
}

void take(Controls& controls, const Session& session) {
  const std::optional<Pick> pick =
      pickBlock(session.simulation.state.position, rayThrough(controls.camera, controls.viewport, controls.x, controls.y));
  if (!pick || session.simulation.model.isFixed(index(pick->block)) || !mayTake(session.game, pick->block)) return;
  controls.hand.block = pick->block;
  controls.hand.place = centre(session.simulation.state.position, index(pick->block));
  controls.hand.turn = orientationOf(session.simulation.state.position, index(pick->block));
  controls.hover.reset();
}

}  // namespace

void pointerMoved(Controls& controls, const Session& session, double x, double y) {
  const double dx = x - controls.x;
  const double dy = y - controls.y;
  controls.x = x;
  controls.y = y;
  const bool dragging = controls.left || controls.right || controls.middle;
  if (controls.look || controls.middle || (dragging && !holds(controls))) {
    orbit(controls.camera, -kOrbitPerPixel * dx, kOrbitPerPixel * dy);
  } else if (holds(controls)) {
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
  updateHover(controls, session);
}

void buttonChanged(Controls& controls, const Session& session, Button button, bool pressed) {
  bool& state = button == Button::left ? controls.left : button == Button::right ? controls.right : controls.middle;
  const bool first = !controls.left && !controls.right;
  state = pressed;
  if (pressed && button != Button::middle && first && !controls.look) take(controls, session);
  if (!controls.left && !controls.right) letGo(controls);
}

void wheelTurned(Controls& controls, double steps) {
  if (holds(controls) && !controls.look) {
    turnHand(controls, TurnAxis::vertical, kWheelTurn * steps);
  } else {
    zoom(controls.camera, steps);
  }
}

void turnHand(Controls& controls, TurnAxis axis, double angle) {
  if (!holds(controls)) return;
  const CameraFrame frame = cameraFrame(controls.camera);
  const Vec3 about = axis == TurnAxis::vertical ? Vec3(Vec3::UnitZ()) : axis == TurnAxis::right ? frame.right : frame.back;
  controls.hand.turn = (Eigen::AngleAxisd(angle, about) * controls.hand.turn).normalized();
}

void letGo(Controls& controls) {
  controls.hand.block = kFloor;
}

void updateHover(Controls& controls, const Session& session) {
  controls.hover.reset();
  if (holds(controls) || controls.look || controls.middle || controls.left || controls.right) return;
  controls.hover =
      pickBlock(session.simulation.state.position, rayThrough(controls.camera, controls.viewport, controls.x, controls.y));
}

}  // namespace springtower
