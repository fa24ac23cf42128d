#include "apps/viewer/view/state.h"

#include "tests/apps/viewer/session/viewer_play.h"

#include <gtest/gtest.h>

namespace springtower {
namespace {

// A long session is replayed, and gone back in, as far as it is remembered.
TEST(ViewerState, ReplaysALongSessionFromWhereItIsRemembered) {
  SceneChoice choice;
  choice.name = "tower:3";
  Viewer viewer(choice, tuningOf(sceneOf(choice)));
  Session& session = viewer.session;
  session.mostLogged = 60;
  for (int i = 0; i < 150; ++i) step(session, idle(session));
  const std::uint64_t first = session.forgotten;
  ASSERT_GT(first, 0U);
  const std::uint64_t end = stateHash(session.simulation);
  travel(viewer, first - 1);
  EXPECT_EQ(session.frame, 150U) << "it is forgotten";
  startReplay(viewer);
  EXPECT_EQ(session.frame, first);
  EXPECT_EQ(viewer.replay->begin, first);
  while (nextInput(*viewer.replay, session)) {
    viewer.paused = viewer.once = true;
    advance(viewer, 0.0);
  }
  EXPECT_EQ(session.frame, 150U);
  EXPECT_FALSE(viewer.replay->differs);
  EXPECT_EQ(stateHash(session.simulation), end);
  seek(viewer, 5);
  EXPECT_EQ(session.frame, first);
  seek(viewer, 1000);
  EXPECT_EQ(session.frame, 150U);
  EXPECT_EQ(stateHash(session.simulation), end);
}

}  // namespace
}  // namespace springtower
