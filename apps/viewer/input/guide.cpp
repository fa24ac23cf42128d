#include "apps/viewer/input/guide.h"

#include "apps/viewer/input/guided_carry.h"
#include "apps/viewer/input/guided_pull.h"
#include "core/limits.h"
#include "core/rotation_vector.h"
#include "core/tuning.h"
#include "solver/block/inertia.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace springtower {
namespace {

constexpr double kDragBegins_px = 6.0;

// Four implicit steps of a frame resolve a closing speed of 3 mm/s (tuning::kMaxImplicitClosing at 0.025 mm), and count as about
// to meet what is nearer than a block falls in a frame, 1.4 mm: lowered faster from there on, each frame takes kMaxLedSteps.
constexpr double kNearSpeed_m_s = 0.02;
constexpr double kTouchSpeed_m_s = 0.0029;
constexpr double kTouchHeight_m = 0.0018;

const ParticleArray& positionsOf(const Session& session) {
  return session.simulation.state.position;
}

// The orientation turned so that its most upright axis is upright.
Eigen::Quaterniond levelled(const Eigen::Quaterniond& turn) {
  const Eigen::Matrix3d axes = turn.toRotationMatrix();
  Eigen::Index up = 0;
  axes.row(2).cwiseAbs().maxCoeff(&up);
  const Vec3 upright = std::copysign(1.0, axes(2, up)) * Vec3::UnitZ();
  return (Eigen::Quaterniond::FromTwoVectors(Vec3(axes.col(up)), upright) * turn).normalized();
}

void beginPull(Guide& guide, Hand& hand, const Session& session, const Vec3& way) {
  const double limit_n = hand.limit_n;
  hand = handOn(session.simulation, guide.block, limit_n);
  hand.rate_rad_s = tuning::kDrawFrequency_rad_s;
  hand.line = way;
  guide.lead = Lead::pulling;
  guide.start = hand.place;
  guide.goal_m = 0.0;
  guide.speed_m_s = 0.0;
  guide.leftOver_px.setZero();
}

// From where the hand is.
void beginCarry(Guide& guide, Hand& hand) {
  hand.line.setZero();
  hand.velocity.setZero();
  hand.rate_rad_s = tuning::kFollowFrequency_rad_s;
  guide.lead = Lead::carrying;
  guide.over = {hand.place, levelled(hand.turn)};
  guide.turned = false;
}

void carryOver(Guide& guide, const Session& session, const Camera& camera, const Viewport& viewport,
               const Eigen::Vector2d& moved_px) {
  const std::size_t held = index(guide.block);
  guide.over.centre = carriedBy(camera, viewport, footprintsOf(positionsOf(session)), held,
                                session.simulation.model.dimensions[held], guide.over, moved_px);
}

// The mouse moves while it pulls.
void pullOn(Guide& guide, const Hand& hand, const Session& session, const Camera& camera, const Viewport& viewport,
            const Eigen::Vector2d& moved_px) {
  const Vec3 middle = centre(positionsOf(session), index(guide.block));
  guide.goal_m += pulledBy(camera, viewport, middle, hand.line, guide.firstWay_px, moved_px);
  guide.leftOver_px += leftOver(camera, viewport, middle, hand.line, guide.firstWay_px, moved_px);
}

void beginMove(Guide& guide, Hand& hand, const Session& session, const Camera& camera, const Viewport& viewport) {
  const std::size_t b = index(guide.block);
  if (isClearAbove(positionsOf(session), b)) {
    hand = handOn(session.simulation, guide.block, hand.limit_n);
    beginCarry(guide, hand);
    carryOver(guide, session, camera, viewport, guide.firstWay_px);
    return;
  }
  const auto way = pullWay(positionsOf(session), b, camera, viewport, guide.firstWay_px);
  if (!way) return;
  beginPull(guide, hand, session, *way);
  pullOn(guide, hand, session, camera, viewport, guide.firstWay_px);
}

// What the mouse has moved beyond the pull counts as carrying from here on.
void leadPull(Guide& guide, Hand& hand, const Session& session, const Camera& camera, const Viewport& viewport, double limit_n) {
  const Simulation& simulation = session.simulation;
  const Vec3 middle = centre(positionsOf(session), index(guide.block));
  const double done = (hand.place - guide.start).dot(hand.line);
  if (isClearAbove(positionsOf(session), index(guide.block))) {
    const Vec3 ahead = (guide.goal_m - done) * hand.line;
    beginCarry(guide, hand);
    guide.over.centre += ahead;
    carryOver(guide, session, camera, viewport, guide.leftOver_px);
    return;
  }
  hand.limit_n = limit_n;
  const double frame_s = simulation.scene.settings.frame_s;
  guide.speed_m_s = pullSpeed(guide.goal_m - done, guide.speed_m_s, frame_s);
  const double ahead = (hand.place - middle).dot(hand.line);
  if (ahead * guide.speed_m_s > 0.0 && std::abs(ahead) >= reachOf(hand, simulation)) guide.speed_m_s = 0.0;
  moveAlongLine(hand, guide.speed_m_s, session.grip.block == hand.block ? session.grip.carried : 0.0, simulation);
  if (guide.speed_m_s == 0.0) return;  // a block that waits does not sink
  hand.place.z() -= pressDepth(-simulation.scene.gravity.at(simulation.time_s).z(), hand.rate_rad_s, frame_s);
}

// Over the landing, clear of what stands beside it.
Place above(const Guide& guide, std::span<const Footprint> all, const Vec3& dimensions) {
  Place place = guide.landing.place;
  const Footprint own = footprintOf(place.centre, place.turn, dimensions);
  place.centre.z() =
      levelBelow(all, index(guide.block), grown(own, kRoomBeside_m)) + 0.5 * (own.top_m - own.bottom_m) + kCarryHeight_m;
  return place;
}

void moveTo(Hand& hand, const Place& next, double frame_s) {
  hand.velocity = (next.centre - hand.place) / frame_s;
  hand.place = next.centre;
  hand.turn = next.turn;
}

void leadCarry(Guide& guide, Hand& hand, const Session& session) {
  const std::size_t held = index(guide.block);
  const Simulation& simulation = session.simulation;
  const Vec3& dimensions = simulation.model.dimensions[held];
  const std::vector<Footprint> all = footprintsOf(positionsOf(session));
  if (guide.lead == Lead::carrying) {
    const std::vector<Place> places = topPlaces(positionsOf(session), simulation.model.dimensions, held, hand.turn);
    guide.landing = landingAt(all, simulation.model.dimensions, held, guide.over, places, guide.turned);
  }
  Place goal = above(guide, all, dimensions);
  if (guide.lead == Lead::carrying && !guide.landing.inRow) goal.centre.z() = std::max(goal.centre.z(), guide.over.centre.z());
  const double frame_s = simulation.scene.settings.frame_s;
  const Place now{hand.place, hand.turn};
  const RigidMotion motion = rigidMotion(simulation.state, held);
  if (guide.lead == Lead::placing && isAt(now, goal) && (motion.centre - goal.centre).norm() < tuning::kGoalDistance_m &&
      motion.velocity.norm() < tuning::kGoalSpeed_m_s) {
    guide.lead = Lead::lowering;
  }
  moveTo(hand, carryStep(all, held, dimensions, now, motion.centre.z(), goal, frame_s), frame_s);
}

// m/s, at a height over the place where the block will lie, m.
double loweringSpeed(double above_m) {
  if (above_m > tuning::kPlaceHeight_m) return tuning::kLowerSpeed_m_s;
  return above_m > kTouchHeight_m ? kNearSpeed_m_s : kTouchSpeed_m_s;
}

// Straight down until it touches; then it is pressed on for a moment and let go.
void leadDown(Guide& guide, Hand& hand, const Session& session) {
  const double frame_s = session.simulation.scene.settings.frame_s;
  hand.velocity.setZero();
  if (guide.lead == Lead::pressing) {
    guide.pressed_s += frame_s;
    if (guide.pressed_s >= tuning::kPressTime_s) {
      guide = {};
      hand.block = kFloor;
    }
    return;
  }
  const double rest = guide.landing.place.centre.z();
  const double step = loweringSpeed(hand.place.z() - rest) * frame_s;
  const double lowest = rest - tuning::kPlaceHeight_m;
  Place next{hand.place, hand.turn};
  next.centre.z() = std::max(next.centre.z() - step, lowest);
  moveTo(hand, next, frame_s);
  if (session.hold == Hold::free && next.centre.z() > lowest) return;
  guide.lead = Lead::pressing;
  guide.pressed_s = 0.0;
}

}  // namespace

bool showsLanding(const Guide& guide) {
  return guide.lead == Lead::carrying || guide.lead == Lead::placing || guide.lead == Lead::lowering;
}

void select(Guide& guide, BlockId block) {
  guide = {};
  guide.lead = Lead::selected;
  guide.block = block;
}

void dragBy(Guide& guide, Hand& hand, const Session& session, const Camera& camera, const Viewport& viewport,
            const Eigen::Vector2d& moved_px) {
  if (guide.lead == Lead::selected) {
    guide.firstWay_px += moved_px;
    if (guide.firstWay_px.norm() >= kDragBegins_px) beginMove(guide, hand, session, camera, viewport);
  } else if (guide.lead == Lead::pulling) {
    pullOn(guide, hand, session, camera, viewport, moved_px);
  } else if (guide.lead == Lead::carrying) {
    carryOver(guide, session, camera, viewport, moved_px);
  }
}

void turnQuarters(Guide& guide, double quarters) {
  if (guide.lead != Lead::carrying) return;
  const Place& shown = guide.landing.inRow ? guide.landing.place : guide.over;
  guide.over.turn = (rotationAbout(Vec3::UnitZ(), 0.5 * std::numbers::pi * quarters) * levelled(shown.turn)).normalized();
  guide.turned = true;
}

void release(Guide& guide, Hand& hand) {
  if (guide.lead == Lead::carrying) {
    guide.lead = Lead::placing;
  } else if (guide.lead == Lead::selected || guide.lead == Lead::pulling || guide.lead == Lead::freely) {
    guide = {};
    hand.block = kFloor;
  }
}

void carryAgain(Guide& guide, Hand& hand) {
  beginCarry(guide, hand);
}

void leadHand(Guide& guide, Hand& hand, const Session& session, const Camera& camera, const Viewport& viewport, double limit_n) {
  switch (guide.lead) {
    case Lead::none:
    case Lead::selected:
    case Lead::freely:
      return;
    case Lead::pulling:
      return leadPull(guide, hand, session, camera, viewport, limit_n);
    case Lead::carrying:
    case Lead::placing:
      return leadCarry(guide, hand, session);
    case Lead::lowering:
    case Lead::pressing:
      return leadDown(guide, hand, session);
  }
}

void setFree(Guide& guide, Hand& hand) {
  if (hand.block == kFloor) return;
  hand.line.setZero();
  hand.velocity.setZero();
  hand.rate_rad_s = tuning::kFollowFrequency_rad_s;
  guide.block = hand.block;
  guide.lead = Lead::freely;
}

void guideAgain(Guide& guide, Hand& hand, const Session& session) {
  if (guide.lead != Lead::freely) return;
  if (isClearAbove(positionsOf(session), index(guide.block))) {
    beginCarry(guide, hand);
  } else {
    select(guide, guide.block);
    hand.block = kFloor;
  }
}

}  // namespace springtower
