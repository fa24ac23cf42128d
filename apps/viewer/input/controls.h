#pragma once

#include "apps/viewer/input/camera.h"
#include "apps/viewer/input/guide.h"
#include "apps/viewer/session/session.h"

#include <optional>

namespace springtower {

// What mouse and keys mean. A press selects a block and a drag moves it, guided (guide.h). A drag beside the blocks, or with the
// middle button, turns the camera. With the free key held the hand moves the block in all six axes: the left button in the plane
// of the screen, the right button (also while the left one is held) along the view, wheel and keys turn it (report 4.8
// and 6.2.1).

inline constexpr double kWheelTurn = 0.2617993877991494;  ///< rad; 15 degrees a step, six for a quarter turn
inline constexpr double kKeyTurn = 0.0872664625997165;    ///< rad; 5 degrees a key press

enum class Button { left, right, middle };

/// The state of mouse, camera and hand.
struct Controls {
  Camera camera;
  Viewport viewport;
  double x = 0.0;  ///< pixels
  double y = 0.0;
  bool left = false;
  bool right = false;
  bool middle = false;
  bool free = false;           ///< the free key is held
  Hand hand;                   ///< what the hand holds and where it moves it
  Guide guide;                 ///< what leads it
  std::optional<Camera> home;  ///< what the camera showed before it went along with a block, and shows again afterwards
  bool looked = false;         ///< the user has turned the camera since
  std::optional<Pick> hover;   ///< what the mouse is over while nothing is held
};

/// The mouse has moved to a place, in pixels of the viewport.
void pointerMoved(Controls& controls, const Session& session, double x, double y);

/// A button has been pressed or released. Left or right selects the block under the mouse if the game allows it, or takes it with
/// the free key; releasing both lets it go.
void buttonChanged(Controls& controls, const Session& session, Button button, bool pressed);

/// The free key has been pressed or released.
void freeKeyChanged(Controls& controls, const Session& session, bool pressed);

/// The wheel has been turned: turns the held block about the vertical, by quarter turns unless it is free, or zooms with an empty
/// hand.
void wheelTurned(Controls& controls, double steps);

/// Turns what the hand holds: about the vertical, the camera's axis to the right, or the one along the view (all in the world's
/// sense of right-hand turns), rad. A guided block turns about the vertical alone, by quarter turns.
enum class TurnAxis { vertical, right, view };
void turnHand(Controls& controls, TurnAxis axis, double angle);

/// The user turns the camera, rad, or comes nearer by steps of the wheel.
void lookRound(Controls& controls, double azimuth, double elevation);
void comeNearer(Controls& controls, double steps);

/// Leads the hand in the coming frame; `limit_n` is its largest force. Call it before each frame is stepped.
void leadHand(Controls& controls, const Session& session, double limit_n);

/// Lets the camera go along with the held block, and back afterwards, for a time that has passed.
void moveCamera(Controls& controls, const Session& session, double elapsed_s);

/// Lets go, as when the scene is changed under the hand.
void letGo(Controls& controls);

/// Finds again what the mouse is over; call once a picture, as blocks move under a resting mouse.
void updateHover(Controls& controls, const Session& session);

}  // namespace springtower
