#pragma once

#include "apps/viewer/session/game.h"
#include "scenarios/recorded/recording.h"
#include "solver/hand/grip.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace springtower {

/// A state that can be gone back to.
struct Keyframe {
  std::uint64_t frame = 0;  ///< frames done
  Tuning tuning;
  Grip grip;
  Game game;
  std::size_t bytes = 0;  ///< of its snapshot, at most
  std::shared_ptr<const Snapshot> snapshot;
};

/// The most that all keyframes take together, bytes, but for kLeastKeyframes that are kept whatever their size. Where it is
/// reached they are thinned out, the older they are the more, so that going back takes frames in proportion to how far it is.
inline constexpr std::size_t kKeyframeBytes = std::size_t{64} << 20U;
inline constexpr std::size_t kLeastKeyframes = 8;

/// The most frames that the log holds: an hour and forty minutes of 60 frames a second, 63 MB in a vector that may have room for
/// 92. Where it is longer, the oldest quarter is forgotten, up to the next keyframe, and can no longer be gone back to or saved;
/// a recording that is written all along has it.
inline constexpr std::size_t kMostLogged = 360000;

/// A running scene with its past. Frame by frame it is a function of the scene and the inputs alone, so going back is to restore
/// the last keyframe before and to step the logged inputs again; undo, history, recording and replay all are that.
struct Session {
  explicit Session(const Scene& scene, int players = 0);

  Scene scene;  ///< as it started
  Tuning tuning;
  Simulation simulation;
  std::uint64_t frame = 0;             ///< frames done
  ParticleArray before;                ///< m, positions one frame ago: pictures lie between them and the present ones
  std::vector<ContactForce> contacts;  ///< as they act now
  Grip grip;
  GripForce gripForce;  ///< of the last frame
  Hold hold = Hold::none;
  Game game;
  std::vector<LoggedFrame> log;          ///< [frame - forgotten]; reaches beyond `frame` after going back
  std::uint64_t forgotten = 0;           ///< frames of which the log has nothing any more; 0, or there is a keyframe after them
  std::size_t mostLogged = kMostLogged;  ///< frames; without bound where the recording is written from the log at the end
  std::uint64_t logKept = 0;             ///< so many of its frames have not changed since the recorder set this
  std::deque<Keyframe> keyframes;        ///< ascending; the first is of frame 0, the next is `forgotten` where that is not 0
  std::vector<std::uint64_t> turns;      ///< frames in which turns of the game began, ascending; the first is 0
  double frame_ms = 0.0;                 ///< what the last frame took
  std::string failure;                   ///< why the simulation ended; empty while it goes on
  /// Called on any thread; false ends a search for an equilibrium, as a signal does. May be empty.
  std::function<bool()> searchGoesOn;
  /// Runs what begins with a search for an equilibrium and may take seconds; returns once it is done, and rethrows what that
  /// throws. If empty, that runs on the thread that steps.
  std::function<void(const std::function<void()>&)> runSearch;
};

/// Finds the equilibrium that the first frame starts from, ahead of it: for uneven towers that takes as long as many frames. Does
/// nothing after the first frame, and leaves a divergence to that.
void prepareStart(Session& session);

/// Goes back to the start and forgets what was played. Takes no longer than a frame where the start was prepared.
void startAgain(Session& session);

/// Steps one frame. A hand that the game does not allow to take its block is left out, in the log too. Does nothing after a
/// failure; a divergence becomes one. What was logged after the present frame is forgotten.
void step(Session& session, const FrameInput& input);

/// The frame that the log ends with.
std::uint64_t lastLogged(const Session& session);

/// Goes to another frame of the log; the game and the hand's grip go with it. What was logged after it stays until the next step,
/// so one can go forth again. Precondition: session.forgotten <= frame <= lastLogged(session).
void goTo(Session& session, std::uint64_t frame);

/// The frame that undoing the last move leads to: the begin of this turn, or of the one before when nothing has been drawn yet.
/// Empty when there is no move to undo, or it is forgotten.
std::optional<std::uint64_t> undoFrame(const Session& session);

/// Positions between the last two frames, m; `share` 0 is the frame before, 1 the present one.
void between(const Session& session, double share, ParticleArray& position);

/// Turns passing time into frames of fixed length. The physics never waits for a picture: a slow picture is followed by several
/// frames. When the machine cannot keep up, time is dropped, `kept` of it is left.
struct Pacer {
  double rate = 1.0;       ///< simulated over real time: 1, or less for slow motion
  double waiting_s = 0.0;  ///< simulated time that is due and not stepped yet, less than a frame after `due`
  double wanted_s = 0.0;   ///< simulated time that was due, of late
  double done_s = 0.0;     ///< and stepped, of late; both fade over a second
  bool slow = false;       ///< whether the machine does not keep up: less than 95 % of what was due

  /// How many frames are due after `elapsed_s` more real seconds, at most what takes `frame_ms` each for the time a picture may
  /// take (a tenth of a second in all, but at least one).
  int due(double elapsed_s, double frame_s, double frame_ms);
  /// Simulated time over what was due, of late, 0..1.
  [[nodiscard]] double kept() const { return wanted_s > 0.0 ? std::min(1.0, done_s / wanted_s) : 1.0; }
  /// Where between the last two frames the picture is, 0..1.
  [[nodiscard]] double share(double frame_s) const { return waiting_s / frame_s; }
};

}  // namespace springtower
