#pragma once

#include "apps/viewer/session/session.h"

#include <algorithm>
#include <cmath>

namespace springtower {

/// Input with an empty hand and the tuning as it is.
inline FrameInput idle(const Session& session) {
  return {{}, session.tuning};
}

/// Steps with an empty hand.
inline void wait(Session& session, int frames) {
  for (int i = 0; i < frames; ++i) step(session, idle(session));
}

/// A hand that takes a block as it lies.
inline Hand handOn(const Session& session, std::size_t block) {
  return handOn(session.simulation, blockId(block));
}

/// Leads the hand in a straight line by `way` at a speed, then holds it still for a time.
inline void lead(Session& session, Hand& hand, const Vec3& way, double speed_m_s, double still_s = 0.2) {
  const double frame_s = session.scene.settings.frame_s;
  const int frames = std::max(1, static_cast<int>(std::ceil(way.norm() / (speed_m_s * frame_s))));
  const Vec3 from = hand.place;
  for (int i = 1; i <= frames; ++i) {
    hand.place = from + way * (static_cast<double>(i) / frames);
    step(session, {hand, session.tuning});
  }
  for (int i = 0; i < std::lround(still_s / frame_s); ++i) step(session, {hand, session.tuning});
}

/// Draws a block out along its length (its own x axis, towards `side` = -1 or 1), lifts it over the top, turns it across the row
/// it lands on if `turned`, lays it down over the axis of the tower and lets go.
inline void drawAndPlace(Session& session, std::size_t block, double side, double top_m, bool turned) {
  Hand hand = handOn(session, block);
  const Vec3 along = side * meanEdge(session.simulation.state.position, block, 0).normalized();
  const double height = session.simulation.model.dimensions[block].z();
  lead(session, hand, 0.13 * along, 0.15);
  lead(session, hand, Vec3(0.0, 0.0, top_m + 0.03 - hand.place.z()), 0.4);
  if (turned) hand.turn = Eigen::AngleAxisd(0.5 * 3.14159265358979323846, Vec3::UnitZ()) * hand.turn;
  lead(session, hand, Vec3(-hand.place.x(), -hand.place.y(), 0.0), 0.25, 0.4);
  lead(session, hand, Vec3(0.0, 0.0, top_m + 0.5 * height + 0.0005 - hand.place.z()), 0.1, 0.3);
  wait(session, 2);
}

}  // namespace springtower
