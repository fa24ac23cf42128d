#include "apps/viewer/session/recording.h"
#include "apps/viewer/session/session.h"
#include "scenarios/recorded/recorded_game.h"
#include "solver/hand/played_frame.h"
#include "solver/metrics/measures.h"
#include "tests/apps/commands/loose_tower.h"
#include "tests/apps/viewer/session/viewer_play.h"
#include "tests/support/program.h"

#include <fstream>
#include <functional>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sstream>
#include <thread>
#include <vector>

namespace springtower {
namespace {

constexpr double kFrame_s = 1.0 / 60.0;

// A session in which something happens: a block is pushed, and friction is changed on the way.
Session playedSession(int frames) {
  Session session(bitCodeScene(kLooseTower));
  Hand hand = handOn(session, kLooseBlock);
  Tuning tuning = session.tuning;
  for (int i = 0; i < frames; ++i) {
    if (i == 40) tuning.friction = 0.35;
    hand.place.y() -= 0.001;
    hand.limit_n = 3.0;
    step(session, {i > 20 && i < 60 ? hand : Hand{}, tuning});
  }
  return session;
}

TEST(ViewerPacer, StepsAsManyFramesAsTimePasses) {
  Pacer pacer;
  int frames = 0;
  for (int picture = 0; picture < 1000; ++picture) {
    frames += pacer.due(0.01 + 0.004 * (picture % 3), kFrame_s, 1.0);
    EXPECT_GE(pacer.share(kFrame_s), 0.0);
    EXPECT_LT(pacer.share(kFrame_s), 1.0);
  }
  EXPECT_NEAR(frames * kFrame_s, 334 * 0.01 + 333 * (0.014 + 0.018), 2 * kFrame_s);
  EXPECT_FALSE(pacer.slow);
}

TEST(ViewerPacer, ASlowPictureIsFollowedBySeveralFrames) {
  Pacer pacer;
  EXPECT_EQ(pacer.due(3.5 * kFrame_s, kFrame_s, 1.0), 3);
  EXPECT_NEAR(pacer.share(kFrame_s), 0.5, 1e-9);
}

TEST(ViewerPacer, SaysWhenTheMachineIsTooSlow) {
  Pacer pacer;
  for (int i = 0; i < 100; ++i) {
    const int frames = pacer.due(0.2, kFrame_s, 40.0);  // 2 frames of 40 ms for 12 that are due
    EXPECT_EQ(frames, 2);
  }
  EXPECT_TRUE(pacer.slow);
  EXPECT_NEAR(pacer.kept(), 2.0 / 12.0, 0.01);
  // It recovers once frames get cheap.
  for (int i = 0; i < 300; ++i) pacer.due(0.02, kFrame_s, 1.0);
  EXPECT_FALSE(pacer.slow);
}

TEST(ViewerPacer, SlowMotionThatWasAskedForIsNotSlowness) {
  Pacer pacer;
  pacer.rate = 0.25;
  int frames = 0;
  for (int i = 0; i < 400; ++i) frames += pacer.due(0.01, kFrame_s, 1.0);
  EXPECT_NEAR(frames, 60, 1);
  EXPECT_FALSE(pacer.slow);
}

TEST(ViewerSession, PicturesLieBetweenTheLastTwoFrames) {
  Scene scene = bitCodeScene("(010)");
  scene.blocks[0].velocity = {1.0, 0.0, 0.0};
  Session session(scene);
  step(session, idle(session));
  ParticleArray half;
  between(session, 0.5, half);
  const Vec3 middle = 0.5 * (session.before.at(0, 0) + session.simulation.state.position.at(0, 0));
  EXPECT_LT((half.at(0, 0) - middle).norm(), 1e-15);
  EXPECT_GT((session.before.at(0, 0) - session.simulation.state.position.at(0, 0)).norm(), 0.01);
}

TEST(ViewerSession, GoesBackAndForthToTheVeryStatesItHad) {
  Session session = playedSession(100);
  const std::vector<LoggedFrame> log = session.log;
  ASSERT_EQ(log.size(), 100U);
  for (const std::uint64_t frame : {99U, 45U, 44U, 70U, 1U, 100U, 30U}) {
    goTo(session, frame);
    EXPECT_EQ(session.frame, frame);
    EXPECT_EQ(stateHash(session.simulation), log[frame - 1].hash) << frame;
  }
  goTo(session, 0);
  EXPECT_EQ(session.tuning.friction, 0.4);
  goTo(session, 50);
  EXPECT_EQ(session.tuning.friction, 0.35);
  // A step into another future forgets the old one.
  step(session, idle(session));
  EXPECT_EQ(session.log.size(), 51U);
  EXPECT_NE(session.log.back().hash, log[50].hash);
}

// A session that runs for days keeps its last hours, and its start.
TEST(ViewerSession, ForgetsTheOldestFramesOfALongLog) {
  Session whole = playedSession(0);
  Session session = playedSession(0);
  session.mostLogged = 100;
  const auto play = [&](Session& played) {
    Tuning tuning = played.tuning;
    tuning.friction = 0.3 + 1e-3 * static_cast<double>(played.frame % 7);
    step(played, {Hand{}, tuning});
  };
  for (int i = 0; i < 300; ++i) {
    play(session);
    play(whole);
    ASSERT_LE(session.log.size(), 100U);
    ASSERT_EQ(lastLogged(session), session.frame);
  }
  EXPECT_GT(session.forgotten, 199U) << "what is kept is at most 100 frames";
  EXPECT_GE(session.log.size(), 100U - 25U - 30U) << "a quarter, and up to the next keyframe";
  for (const std::uint64_t frame : {session.forgotten, std::uint64_t{299}, session.forgotten + 1, std::uint64_t{300}}) {
    goTo(session, frame);
    EXPECT_EQ(stateHash(session.simulation), whole.log[frame - 1].hash) << frame;
  }
  startAgain(session);
  EXPECT_EQ(lastLogged(session), 0U);
  play(session);
  EXPECT_EQ(session.log[0].hash, whole.log[0].hash);
}

TEST(ViewerSession, AForgottenMoveCannotBeTakenBack) {
  Session session(towerScene(3), 1);
  session.mostLogged = 60;
  for (int i = 0; i < 150; ++i) step(session, idle(session));
  ASSERT_GT(session.forgotten, 0U);
  session.game.phase = Phase::moving;
  session.game.turnFrame = session.forgotten;
  EXPECT_EQ(undoFrame(session), session.forgotten);
  session.game.turnFrame = session.forgotten - 1;
  EXPECT_FALSE(undoFrame(session));
}

// What is logged is what acted, so that it plays the same without the rules of the game.
TEST(ViewerSession, LogsNoHandThatTheGameDoesNotAllow) {
  Session session(towerScene(6), 1);
  const Hand below = handOn(session, 0);
  const Hand top = handOn(session, 17);
  step(session, {top, session.tuning});
  step(session, {below, session.tuning});
  EXPECT_EQ(session.log[0].input.hand.block, kFloor);
  EXPECT_EQ(session.log[1].input.hand.block, blockId(0));
}

// A long way costs what lies between keyframes, not all that was played, in either direction.
TEST(ViewerSession, KeepsItsKeyframesUntilAnotherFutureBegins) {
  Session session = playedSession(100);
  const std::size_t keyframes = session.keyframes.size();
  EXPECT_EQ(keyframes, 4U);  // of frames 0, 30, 60 and 90
  goTo(session, 5);
  EXPECT_EQ(session.keyframes.size(), keyframes);
  const std::uint64_t steps = session.simulation.counters.steps;
  goTo(session, 91);
  EXPECT_EQ(session.keyframes.size(), keyframes);
  EXPECT_GT(session.simulation.counters.steps, steps);
  goTo(session, 45);
  step(session, idle(session));
  EXPECT_EQ(session.keyframes.size(), 2U);
}

// With keyframes so large that no more than thirty fit.
TEST(ViewerSession, ItsHistoryIsBoundedAndLeadsBackAllTheWay) {
  Session session(bitCodeScene("(010)"));
  wait(session, 30);
  for (Keyframe& key : session.keyframes) key.bytes = kKeyframeBytes / 30;
  for (int i = 0; i < 5000; ++i) {
    step(session, idle(session));
    session.keyframes.back().bytes = kKeyframeBytes / 30;
  }
  std::size_t bytes = 0;
  for (const Keyframe& key : session.keyframes) bytes += key.bytes;
  EXPECT_LE(bytes, kKeyframeBytes + kKeyframeBytes / 30);
  EXPECT_GE(session.keyframes.size(), 25U);
  EXPECT_EQ(session.keyframes.front().frame, 0U);
  for (std::size_t i = 1; i + 1 < session.keyframes.size(); ++i) {
    const auto gap = static_cast<double>(session.keyframes[i].frame - session.keyframes[i - 1].frame);
    const auto ago = static_cast<double>(session.frame - session.keyframes[i - 1].frame);
    EXPECT_LE(gap, std::max(120.0, 0.5 * ago)) << "a way back takes frames in proportion to how far it is";
  }
  const std::vector<LoggedFrame> log = session.log;
  for (const std::uint64_t frame : {4990U, 3000U, 17U, 1000U, 5030U}) {
    goTo(session, frame);
    EXPECT_EQ(stateHash(session.simulation), log[frame - 1].hash) << frame;
  }
}

TEST(ViewerSession, SnapshotsTakeNoMoreThanTheyAreCountedFor) {
  Session session(towerScene(6));
  wait(session, 90);
  ASSERT_EQ(session.keyframes.size(), 4U);
  for (const Keyframe& key : session.keyframes) {
    EXPECT_GT(key.bytes, 18U * 48U * sizeof(double)) << "positions and velocities alone";
    EXPECT_LT(key.bytes, kKeyframeBytes / 60);
  }
}

TEST(ViewerSession, GoesBackOverAChangeOfMethodAndTolerance) {
  Session session(bitCodeScene(kLooseTower));
  Tuning tuning = session.tuning;
  for (int i = 0; i < 80; ++i) {
    if (i == 20) tuning.method = Method::midpoint;
    if (i == 30) tuning.tolerance_m = 1e-4;
    if (i == 40) tuning.method = Method::implicit;
    step(session, {{}, tuning});
  }
  const std::vector<LoggedFrame> log = session.log;
  EXPECT_EQ(session.simulation.scene.settings.method, Method::implicit);
  for (const std::uint64_t frame : {35U, 25U, 75U, 10U, 45U, 80U}) {
    goTo(session, frame);
    EXPECT_EQ(stateHash(session.simulation), log[frame - 1].hash) << frame;
  }
}

// Frames that begin with a search, the first and those after a change of method or tolerance, run where the session is told to
// run them, all others on the thread that steps; the states are the same.
TEST(ViewerSession, RunsASearchOnAnotherThread) {
  Session plain(bitCodeScene(kLooseTower));
  Session session(bitCodeScene(kLooseTower));
  std::vector<std::uint64_t> searched;
  session.runSearch = [&](const std::function<void()>& search) {
    searched.push_back(session.frame);
    std::thread(search).join();
  };
  Tuning tuning = plain.tuning;
  for (int i = 0; i < 10; ++i) {
    if (i == 4) tuning.tolerance_m = 1e-4;
    if (i == 6) tuning.friction = 0.35;
    if (i == 8) tuning.method = Method::midpoint;
    step(plain, {{}, tuning});
    step(session, {{}, tuning});
    EXPECT_EQ(stateHash(session.simulation), stateHash(plain.simulation)) << i;
  }
  EXPECT_THAT(searched, testing::ElementsAre(0, 4, 8));
}

TEST(ViewerSession, ALiveChangeOfStiffnessHardlyMovesTheTower) {
  Session session(towerScene(6));
  wait(session, 90);
  const ParticleArray before = session.simulation.state.position;
  Tuning tuning = session.tuning;
  tuning.method = Method::midpoint;
  for (int i = 0; i < 60; ++i) step(session, {{}, tuning});
  EXPECT_LT(largestCornerMove(before, session.simulation.state.position), 2e-4);
}

TEST(ViewerRecording, ReadsBackAndReplaysToTheSameStates) {
  const Session session = playedSession(100);
  SceneChoice choice;
  choice.name = kLooseTower;
  choice.players = 0;
  const ScratchFolder scratch;
  const std::string path = scratch.file("recording.jsonl");
  {
    std::ofstream stream(path);
    writeRecording(stream, {choice, session.log});
  }
  Replay replay{readRecording(path), {}};
  ASSERT_EQ(replay.recording.frames.size(), 100U);
  Session again(sceneOf(replay.recording.choice), replay.recording.choice.players);
  while (const auto input = nextInput(replay, again)) {
    step(again, *input);
    compare(replay, again);
  }
  EXPECT_EQ(again.frame, 100U);
  EXPECT_FALSE(replay.differs);
  EXPECT_EQ(stateHash(again.simulation), stateHash(session.simulation));
}

// A search for an equilibrium comes before the first frame, by the tuning that this frame has.
TEST(ViewerRecording, OfAnotherTuningThanItsScenesPlaysToTheSameStates) {
  SceneChoice choice;
  choice.name = "tower:3";
  const Tuning own = tuningOf(sceneOf(choice));
  std::vector<Tuning> tunings(5, own);
  tunings[0].method = Method::rigidPgs;
  tunings[1].method = Method::semiImplicitEuler;
  tunings[2].method = Method::xpbd;
  tunings[3].tolerance_m = 1e-4;
  tunings[4].friction = 0.5;
  for (const Tuning& tuning : tunings) {
    SCOPED_TRACE(testing::Message() << nameOf(tuning.method) << ", " << tuning.tolerance_m << " m, " << tuning.friction);
    Session session(withTuning(sceneOf(choice), tuning));
    Session late(sceneOf(choice));  // where it is chosen in the lab, before the first frame
    for (Session* played : {&session, &late}) {
      prepareStart(*played);
      for (int i = 0; i < 5; ++i) step(*played, {Hand{}, tuning});
    }
    EXPECT_EQ(stateHash(late.simulation), stateHash(session.simulation));
    Replay replay{{choice, session.log}, {}};
    Session again(withTuning(sceneOf(choice), replay.tuning()));
    prepareStart(again);
    while (const auto input = nextInput(replay, again)) {
      step(again, *input);
      compare(replay, again);
    }
    EXPECT_EQ(again.frame, 5U);
    EXPECT_FALSE(replay.differs) << *replay.differs;
    goTo(late, 2);
    EXPECT_EQ(stateHash(late.simulation), session.log[1].hash);
  }
}

// What plays it without the viewer (`springtower profile`, the instruction counts) plays the same frames.
TEST(ViewerRecording, TheRecordedGameReplaysToTheStatesOfTheEngineAlone) {
  const Recording& game = recordedGame();
  Replay replay{game, {}};
  Session session(sceneOf(game.choice), game.choice.players);
  Simulation simulation(recordedTower());
  Grip grip;
  std::vector<ContactForce> contacts;
  while (const auto input = nextInput(replay, session)) {
    step(session, *input);
    stepPlayed(input->hand, grip, contacts, simulation);
    ASSERT_EQ(stateHash(session.simulation), stateHash(simulation)) << "frame " << session.frame;
    EXPECT_EQ(session.log.back().input.hand.block, input->hand.block) << "the game allowed all of it";
  }
  EXPECT_EQ(session.frame, game.frames.size());
  EXPECT_EQ(session.game.moves, 2);
  EXPECT_EQ(session.game.phase, Phase::over);
}

TEST(ViewerRecording, NamesTheFrameThatDiffers) {
  const Session session = playedSession(60);
  Replay replay{{{}, session.log}, {}};
  replay.recording.frames[29].input.hand.place.y() += 1e-9;  // the hand holds something from frame 22 on
  Session again(bitCodeScene(kLooseTower));
  while (const auto input = nextInput(replay, again)) {
    step(again, *input);
    compare(replay, again);
  }
  ASSERT_TRUE(replay.differs);
  EXPECT_EQ(*replay.differs, 30U);
}

// What a file holds while a game goes on is at any time the game so far, also after ways back and a new begin.
TEST(ViewerRecording, FollowsASessionBackAndForth) {
  const ScratchFolder scratch;
  OutputFile file(scratch.file("game"), "--record");
  RecordingWriter writer(file);
  SceneChoice choice;
  choice.name = kLooseTower;
  Session session = playedSession(0);
  const auto play = [&](int frames, double friction) {
    Tuning tuning = session.tuning;
    tuning.friction = friction;
    for (int i = 0; i < frames; ++i) {
      step(session, {Hand{}, tuning});
      writer.follow(choice, session);
    }
  };
  const auto written = [&] {
    file.stream().flush();
    return contentOf(scratch.file("game.partial"));
  };
  const auto expected = [&](std::size_t frames) {
    std::ostringstream text;
    writeRecording(text, {choice, {session.log.begin(), session.log.begin() + static_cast<std::ptrdiff_t>(frames)}, {}});
    return text.str();
  };
  play(30, 0.4);
  EXPECT_EQ(written(), expected(30));
  goTo(session, 10);
  writer.follow(choice, session);
  EXPECT_EQ(written(), expected(30)) << "one may go forth again";
  play(5, 0.3);
  EXPECT_EQ(written(), expected(15));
  session = playedSession(0);
  play(8, 0.5);
  EXPECT_EQ(written(), expected(8));
  choice.players = 2;
  writer.follow(choice, session);
  EXPECT_EQ(written(), expected(8));
  goTo(session, 6);
  writer.finish(choice, session);
  EXPECT_EQ(contentOf(scratch.file("game")), expected(6));
}

TEST(ViewerRecording, AFileWrittenAllAlongHasWhatTheSessionForgets) {
  const ScratchFolder scratch;
  SceneChoice choice;
  choice.name = kLooseTower;
  OutputFile files[] = {OutputFile(scratch.file("whole"), "--record"), OutputFile(scratch.file("game"), "--record")};
  RecordingWriter writers[] = {RecordingWriter(files[0]), RecordingWriter(files[1])};
  Session sessions[] = {playedSession(0), playedSession(0)};
  sessions[1].mostLogged = 50;
  const auto play = [&](int frames, double friction) {
    for (int i = 0; i < 2 * frames; ++i) {
      Session& session = sessions[i % 2];
      Tuning tuning = session.tuning;
      tuning.friction = friction;
      step(session, {Hand{}, tuning});
      writers[i % 2].follow(choice, session);
    }
  };
  const auto written = [&](std::size_t i) {
    files[i].stream().flush();
    return contentOf(scratch.file(i == 0 ? "whole.partial" : "game.partial"));
  };
  play(200, 0.4);
  EXPECT_GT(sessions[1].forgotten, 100U);
  EXPECT_EQ(written(1), written(0));
  for (Session& session : sessions) goTo(session, 185);
  play(5, 0.3);
  EXPECT_EQ(written(1), written(0));
  for (Session& session : sessions) startAgain(session);
  play(8, 0.5);
  EXPECT_EQ(written(1), written(0));
  EXPECT_EQ(sessions[1].forgotten, 0U);
  play(100, 0.5);
  for (Session& session : sessions) goTo(session, 100);
  for (std::size_t i = 0; i < 2; ++i) writers[i].finish(choice, sessions[i]);
  EXPECT_EQ(contentOf(scratch.file("game")), contentOf(scratch.file("whole")));
  EXPECT_EQ(readRecording(scratch.file("game")).frames.size(), 100U);
}

// A pipe is written at the end, from all frames.
TEST(ViewerRecording, ASessionWhoseFileCannotBeCutForgetsNothing) {
  const ScratchFolder scratch;
  SceneChoice choice;
  choice.name = kLooseTower;
  OutputFile file("/dev/null", "--record");
  RecordingWriter writer(file);
  Session session = playedSession(0);
  session.mostLogged = 10;
  writer.follow(choice, session);
  for (int i = 0; i < 100; ++i) step(session, idle(session));
  EXPECT_EQ(session.forgotten, 0U);
  EXPECT_EQ(session.log.size(), 100U);
}

}  // namespace
}  // namespace springtower
