#pragma once

#include "apps/viewer/input/camera.h"
#include "apps/viewer/session/session.h"

#include <optional>

namespace springtower {

// What mouse and keys mean. Left drag moves a block in the plane of the screen, right drag (also while the left button is held)
// along the view; wheel and keys turn it. A drag beside the blocks, or with the middle button, goes round the tower; with the
// look key held the mouse goes round the tower while the hand keeps its block where it is (report 4.8 and 6.2.1).

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
  bool look = false;          ///< the look key is held
  Hand hand;                  ///< what the hand holds and where it moves it
  std::optional<Pick> hover;  ///< what the mouse is over while nothing is held
};

/// The mouse has moved to a place, in pixels of the viewport.
void pointerMoved(Controls& controls, const Session& session, double x, double y);

/// A button has been pressed or released. Left or right takes the block under the mouse if the game allows it; releasing both
/// lets it go.
void buttonChanged(Controls& controls, const Session& session, Button button, bool pressed);

/// The wheel has been turned: turns the held block about the vertical, or zooms with an empty hand or the look key.
void wheelTurned(Controls& controls, double steps);

/// Turns what the hand holds: about the vertical, the camera's axis to the right, or the one along the view (all in the world's
/// sense of right-hand turns), rad.
enum class TurnAxis { vertical, right, view };
void turnHand(Controls& controls, TurnAxis axis, double angle);

/// Lets go, as when the scene is changed under the hand.
void letGo(Controls& controls);

/// Finds again what the mouse is over; call once a picture, as blocks move under a resting mouse.
void updateHover(Controls& controls, const Session& session);

}  // namespace springtower
