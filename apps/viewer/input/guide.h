#pragma once

#include "apps/viewer/input/camera.h"
#include "apps/viewer/input/places.h"
#include "apps/viewer/session/session.h"

#include <optional>

namespace springtower {

// Leads the hand: what a drag means for a block, from the press to where it lies again. It moves only the hand's target; the
// hand's springs do the rest, within their limits.

/// What the hand does with its block.
enum class Lead {
  none,
  selected,  ///< pressed, and not dragged yet
  pulling,   ///< along one of its axes
  carrying,  ///< free of all others
  placing,   ///< let go by the user, on the way over its place
  lowering,
  pressing,  ///< lies, and is held for a moment
  freely     ///< in all six axes, with the free key
};

/// Where a guided move stands. Plain values.
struct Guide {
  Lead lead = Lead::none;
  BlockId block = kFloor;                                 ///< of the move
  Eigen::Vector2d firstWay_px = Eigen::Vector2d::Zero();  ///< of the mouse from the press until the pull began
  Eigen::Vector2d leftOver_px = Eigen::Vector2d::Zero();  ///< of the mouse's motion while it pulled, across the line
  Vec3 start = Vec3::Zero();                              ///< m, the block's centre when the pull began
  double goal_m = 0.0;                                    ///< how far along its line the mouse is
  double speed_m_s = 0.0;                                 ///< of the hand along the line
  Place over;                                             ///< where the mouse carries the block
  bool turned = false;                                    ///< the user has turned it: it keeps its direction
  Landing landing;                                        ///< where it would lie
  double pressed_s = 0.0;                                 ///< how long it has been pressed down
};

/// Whether the guide shows where the block will lie.
bool showsLanding(const Guide& guide);

/// Presses on a block: selects it.
void select(Guide& guide, BlockId block);

/// The mouse moves by some pixels with the button held. A drag of some pixels begins the move: a block with nothing over it is
/// lifted, any other is pulled along one of its axes.
void dragBy(Guide& guide, Hand& hand, const Session& session, const Camera& camera, const Viewport& viewport,
            const Eigen::Vector2d& moved_px);

/// Turns a carried block by quarter turns about the vertical.
void turnQuarters(Guide& guide, double quarters);

/// The button is released: a carried block goes to where it would lie, any other is let go as it is.
void release(Guide& guide, Hand& hand);

/// Takes up again what is being laid down.
void carryAgain(Guide& guide, Hand& hand);

/// Moves the hand in the coming frame. Call it before each frame is stepped.
void leadHand(Guide& guide, Hand& hand, const Session& session, const Camera& camera, const Viewport& viewport, double limit_n);

/// Takes a block that the hand moves freely into the guide again, or gives it to the free hand.
void guideAgain(Guide& guide, Hand& hand, const Session& session);
void setFree(Guide& guide, Hand& hand);

}  // namespace springtower
