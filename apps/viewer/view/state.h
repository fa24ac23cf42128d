#pragma once

#include "apps/viewer/input/controls.h"
#include "apps/viewer/session/recording.h"
#include "apps/viewer/view/colours.h"
#include "apps/viewer/view/layout.h"
#include "apps/viewer/view/picture.h"
#include "apps/viewer/view/poses.h"
#include "apps/viewer/view/statics.h"
#include "core/tuning.h"
#include "solver/metrics/penetration.h"

#include <array>
#include <cstdint>
#include <iosfwd>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace springtower {

/// What one frame cost, ms.
struct FrameBar {
  std::array<float, kStages> stage_ms{};
  float frame_ms = 0.0F;  ///< the whole frame, with the hand, contact forces and the game
};
inline constexpr std::size_t kBars = 240;

/// How long a message is shown while time goes on, s; it fades in the last part of that.
inline constexpr double kMessage_s = 3.0;
inline constexpr double kMessageFade_s = 0.5;

/// What stands over the picture: a player's few words, the panel of what can be changed and measured, the time line of a game
/// that passes again, or notices alone.
enum class Mode : std::size_t { play, lab, replay, bare };
inline constexpr std::array<std::string_view, 4> kModeNames = {"play", "lab", "replay", "bare"};

/// Where the replay of a fall is (view/fall.h): none, going back, passing at a quarter of its speed, going on at that speed, or
/// over and the clock stopped.
enum class FallStage { none, rewinding, passing, following, stopped };

/// A fall that is shown again, from the poses that were kept.
struct FallReplay {
  FallStage stage = FallStage::none;
  double at = 0.0;             ///< the pose that is shown, in frames from the oldest one
  std::uint64_t end = 0;       ///< the frame in which the clock stops
  std::optional<Camera> goal;  ///< where the camera goes, until the user turns it
  BlockId cause = kFloor;      ///< the block that did it
};

/// What happened since the viewer was started, for its report.
struct Watch {
  bool measures = false;  ///< penetration, every sixth frame
  Penetration deepest;
  double deepestTime_s = 0.0;
  double mostMove_m = 0.0;   ///< largest move of any corner from the scene's start
  std::uint64_t frames = 0;  ///< stepped, over all resets and ways back
  std::uint64_t pictures = 0;
  double firstPicture_s = 0.0;  ///< from the program's start
  double firstFrame_s = 0.0;    ///< from the first picture on, until a frame was stepped
  int failures = 0;             ///< divergences
  bool interrupted = false;     ///< a signal has ended it
};

/// A viewer: a session, the user's hand and view, and what is shown. Independent of windows and OpenGL.
struct Viewer {
  Viewer(SceneChoice choice, const Tuning& tuning);

  SceneChoice choice;
  Tuning tuning;  ///< as the user has set it, from the next frame on
  Session session;
  ParticleArray start;  ///< m, positions at the scene's start
  Controls controls;
  Pacer pacer;
  bool paused = false;
  bool once = false;  ///< one frame although paused
  Overlay overlay = Overlay::wood;
  bool arrows = false;
  Mode mode = Mode::bare;
  bool heldOnce = false;  ///< a block has been held since the program began
  Poses poses;            ///< of the last frames
  FallReplay fall;
  StaticsAnswer hovered;       ///< statics without the block under the mouse
  StaticsAnswer tower;         ///< and of the tower, without what the hand holds
  std::optional<float> scale;  ///< of words and buttons; empty: the screen's
  Extent window;               ///< that words and panels were last laid out for
  Layout layout;               ///< where they lay
  double limit_n = tuning::kGripForce_n;
  std::optional<Replay> replay;
  std::string message;      ///< what the user is shown, for kMessage_s unless it is paused
  std::string lastMessage;  ///< as it was a picture ago
  double messageAge_s = 0.0;
  bool fresh = false;  ///< the scene has begun anew and was not drawn yet: its first frame, which may take long, waits for that
  std::array<FrameBar, kBars> bars{};
  std::size_t bar = 0;      ///< the oldest one
  float picture_ms = 0.0F;  ///< what drawing the last picture took
  Watch watch;
  ParticleArray shown;  ///< m, positions of the picture
  PenetrationWorkspace workspace;
};

/// Lets real time pass: steps the frames that are due, with the hand or the replay.
void advance(Viewer& viewer, double elapsed_s);

/// Begins anew with this scene. A scene that is wrong leaves the old one and says so in `message`.
void restart(Viewer& viewer, const SceneChoice& choice);

/// Begins anew with the same scene; at once where it can be made from its name alone and the tuning is as it was. A file is read
/// again.
void again(Viewer& viewer);

/// Goes to a frame of the log, pausing; the hand lets go.
void travel(Viewer& viewer, std::uint64_t frame);

/// Takes back the last move of the game.
void undo(Viewer& viewer);

/// What is to be drawn now.
Picture pictureOf(Viewer& viewer);

/// Plays the recording, or what has been played so far, from its first frame on.
void startReplay(Viewer& viewer);

/// Ends a replay where it is: the game goes on from there.
void playOn(Viewer& viewer);

/// Goes to a frame of what is replayed, also to one that was not reached yet.
void seek(Viewer& viewer, std::uint64_t frame);

/// Changes the mode; a replay begins or ends with Mode::replay.
void setMode(Viewer& viewer, Mode mode);

/// Follows what statics says of the tower and of the block under the mouse, as far as it is shown. Call it once a picture.
/// `waits`: the answers are there on return.
void followStatics(Viewer& viewer, bool waits);

/// Whether the ring around the tower shows how far it may lean.
bool showsMargin(const Viewer& viewer);

/// Writes the report: frames, pictures, penetration, moves, game, hand and camera, as JSON.
void writeViewerReport(std::ostream& stream, const Viewer& viewer);

}  // namespace springtower
