#include "apps/viewer/input/controls.h"
#include "solver/metrics/measures.h"
#include "tests/apps/commands/loose_tower.h"
#include "tests/apps/viewer/session/viewer_play.h"

#include <cmath>
#include <gtest/gtest.h>

namespace springtower {
namespace {

TEST(ViewerControls, WithTheFreeKeyItDragsInThePlaneOfTheScreenAndAlongTheView) {
  Session session(bitCodeScene(kLooseTower));
  Controls controls;
  showAll(controls.camera, session.simulation.state.position);
  const auto at = seenAt(controls.camera, controls.viewport, session.simulation.state.position.at(0, 1));
  pointerMoved(controls, session, at->x() - 3.0, at->y() - 6.0);
  ASSERT_TRUE(controls.hover);
  const BlockId block = controls.hover->block;
  freeKeyChanged(controls, session, true);
  buttonChanged(controls, session, Button::left, true);
  ASSERT_EQ(controls.hand.block, block);
  const Vec3 start = controls.hand.place;
  const CameraFrame frame = cameraFrame(controls.camera);
  pointerMoved(controls, session, controls.x + 100.0, controls.y - 50.0);
  const Vec3 dragged = controls.hand.place - start;
  EXPECT_NEAR(dragged.dot(frame.back), 0.0, 1e-12);
  EXPECT_NEAR(dragged.dot(frame.right), 100.0 * metresPerPixel(controls.camera, controls.viewport, start), 1e-12);
  // What is under the mouse stays under it.
  const auto from = seenAt(controls.camera, controls.viewport, start);
  const auto to = seenAt(controls.camera, controls.viewport, controls.hand.place);
  EXPECT_NEAR(to->x() - from->x(), 100.0, 1e-6);
  EXPECT_NEAR(to->y() - from->y(), -50.0, 1e-6);
  // Also with the right button held the motion is along the view, towards the viewer when the mouse comes nearer.
  buttonChanged(controls, session, Button::right, true);
  const Vec3 before = controls.hand.place;
  pointerMoved(controls, session, controls.x + 30.0, controls.y + 40.0);
  EXPECT_NEAR((controls.hand.place - before).normalized().dot(frame.back), 1.0, 1e-12);
  buttonChanged(controls, session, Button::right, false);
  EXPECT_EQ(controls.hand.block, block);
  // The middle button turns the camera and leaves the hand alone.
  const Vec3 kept = controls.hand.place;
  const double azimuth = controls.camera.azimuth;
  buttonChanged(controls, session, Button::middle, true);
  pointerMoved(controls, session, controls.x + 50.0, controls.y);
  buttonChanged(controls, session, Button::middle, false);
  EXPECT_NE(controls.camera.azimuth, azimuth);
  EXPECT_EQ(controls.hand.place, kept);
  // The wheel turns the block: six steps are a quarter.
  const Eigen::Quaterniond turn = controls.hand.turn;
  wheelTurned(controls, 6.0);
  EXPECT_NEAR(turn.angularDistance(controls.hand.turn), 0.5 * 3.14159265358979, 1e-9);
  buttonChanged(controls, session, Button::left, false);
  EXPECT_EQ(controls.hand.block, kFloor);
}

TEST(ViewerControls, ADragBesideTheBlocksGoesRound) {
  Session session(bitCodeScene(kLooseTower));
  Controls controls;
  const Camera before = controls.camera;
  pointerMoved(controls, session, 5.0, 5.0);
  buttonChanged(controls, session, Button::left, true);
  pointerMoved(controls, session, 105.0, 25.0);
  EXPECT_EQ(controls.hand.block, kFloor);
  EXPECT_LT(controls.camera.azimuth, before.azimuth);
  EXPECT_GT(controls.camera.elevation, before.elevation);
  buttonChanged(controls, session, Button::left, false);
  wheelTurned(controls, 1.0);
  EXPECT_LT(controls.camera.distance, before.distance);
}

// Moves the mouse over a block's end and presses there. Returns the block.
BlockId pressOnEnd(Controls& controls, const Session& session, std::size_t block) {
  const Vec3 end =
      centre(session.simulation.state.position, block) +
      0.499 * std::copysign(1.0, cameraFrame(controls.camera).back.dot(meanEdge(session.simulation.state.position, block, 0))) *
          meanEdge(session.simulation.state.position, block, 0);
  const auto at = seenAt(controls.camera, controls.viewport, end);
  pointerMoved(controls, session, at->x(), at->y());
  buttonChanged(controls, session, Button::left, true);
  return controls.guide.block;
}

TEST(ViewerControls, APressSelectsAndADragPullsAlongTheBlock) {
  Session session(bitCodeScene(kLooseTower));
  Controls controls;
  showAll(controls.camera, session.simulation.state.position);
  ASSERT_EQ(pressOnEnd(controls, session, kLooseBlock), blockId(kLooseBlock));
  EXPECT_EQ(controls.guide.lead, Lead::selected);
  EXPECT_EQ(controls.hand.block, kFloor) << "a press alone does not take it";
  // Whichever way across the screen: level, along its length, and never stronger than the limit.
  pointerMoved(controls, session, controls.x - 60.0, controls.y + 10.0);
  ASSERT_EQ(controls.guide.lead, Lead::pulling);
  EXPECT_NEAR(std::abs(controls.hand.line.y()), 1.0, 1e-3);
  const Vec3 start = centre(session.simulation.state.position, kLooseBlock);
  double most_n = 0.0;
  for (int i = 0; i < 30; ++i) {
    leadHand(controls, session, 5.0);
    step(session, {controls.hand, session.tuning});
    most_n = std::max(most_n, session.gripForce.force.norm());
  }
  const Vec3 moved = centre(session.simulation.state.position, kLooseBlock) - start;
  EXPECT_LT(moved.y(), -0.01);
  EXPECT_LT(std::hypot(moved.x(), moved.z()), 2e-4);
  EXPECT_LT(most_n, 5.0);
  buttonChanged(controls, session, Button::left, false);
  EXPECT_EQ(controls.hand.block, kFloor) << "not free yet: it stays as it is";
  EXPECT_EQ(controls.guide.lead, Lead::none);
}

TEST(ViewerControls, ABlockOfTheTopIsLiftedTurnedAndLaidDown) {
  Session session(bitCodeScene(kLooseTower));
  wait(session, 30);
  Controls controls;
  showAll(controls.camera, session.simulation.state.position);
  ASSERT_EQ(pressOnEnd(controls, session, 10), blockId(10));
  const auto play = [&](int frames) {
    for (int i = 0; i < frames; ++i) {
      leadHand(controls, session, 5.0);
      step(session, {controls.hand, session.tuning});
    }
  };
  pointerMoved(controls, session, controls.x + 10.0, controls.y);
  ASSERT_EQ(controls.guide.lead, Lead::carrying);
  for (int i = 0; i < 20; ++i) pointerMoved(controls, session, controls.x + 12.0, controls.y + 5.0);
  play(120);
  EXPECT_FALSE(controls.guide.landing.inRow);
  EXPECT_TRUE(controls.guide.landing.fits) << "on the floor";
  const double before = controls.guide.landing.place.turn.angularDistance(controls.hand.turn);
  EXPECT_LT(before, 0.02);
  wheelTurned(controls, 1.0);
  play(60);
  EXPECT_NEAR(std::abs(meanEdge(session.simulation.state.position, 10, 0).normalized().x()), 1.0, 0.01) << "a quarter turn";
  buttonChanged(controls, session, Button::left, false);
  EXPECT_EQ(controls.guide.lead, Lead::placing);
  play(240);
  EXPECT_EQ(controls.guide.lead, Lead::none);
  EXPECT_EQ(controls.hand.block, kFloor);
  EXPECT_NEAR(centre(session.simulation.state.position, 10).z(), 0.5 * kBlockHeight_m, 5e-4);
}

// Looking is not touching: with camera and hover alone a tower moves as one that nobody looks at.
TEST(ViewerControls, LookingMovesNothing) {
  Session session(towerScene(6));
  wait(session, 120);
  const ParticleArray before = session.simulation.state.position;
  Controls controls;
  showAll(controls.camera, before);
  int hovered = 0;
  for (int i = 0; i < 120; ++i) {
    freeKeyChanged(controls, session, i % 3 == 0);
    pointerMoved(controls, session, 640.0 + 200.0 * std::sin(0.3 * i), 400.0 + 150.0 * std::cos(0.2 * i));
    if (i % 10 == 0) wheelTurned(controls, i % 20 == 0 ? 1.0 : -1.0);
    if (i % 30 == 0) buttonChanged(controls, session, Button::middle, i % 60 == 0);
    hovered += controls.hover ? 1 : 0;
    step(session, {controls.hand, session.tuning});
  }
  EXPECT_GT(hovered, 10);
  EXPECT_LT(largestCornerMove(before, session.simulation.state.position), 1e-5);
}

}  // namespace
}  // namespace springtower
