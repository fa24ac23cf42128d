#pragma once

#include "apps/viewer/input/controls.h"
#include "apps/viewer/session/recording.h"
#include "apps/viewer/view/overlays.h"
#include "apps/viewer/view/picture.h"
#include "core/tuning.h"
#include "solver/metrics/penetration.h"

#include <array>
#include <cstdint>
#include <iosfwd>
#include <optional>
#include <string>
#include <vector>

namespace springtower {

/// What one frame cost, ms.
struct FrameBar {
  std::array<float, kStages> stage_ms{};
  float frame_ms = 0.0F;  ///< the whole frame, with the hand, contact forces and the game
};
inline constexpr std::size_t kBars = 240;

/// How long a message is shown while time goes on, s.
inline constexpr double kMessage_s = 3.0;

/// What happened since the viewer was started, for its report.
struct Watch {
  bool measures = false;  ///< penetration, every sixth frame
  Penetration deepest;
  double deepestTime_s = 0.0;
  double mostMove_m = 0.0;   ///< largest move of any corner from the scene's start
  std::uint64_t frames = 0;  ///< stepped, over all resets and ways back
  std::uint64_t pictures = 0;
  double firstPicture_s = 0.0;  ///< from the program's start
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
  bool panels = true;
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

/// Goes to a frame of the log, pausing; the hand lets go.
void travel(Viewer& viewer, std::uint64_t frame);

/// Takes back the last move of the game.
void undo(Viewer& viewer);

/// What is to be drawn now.
Picture pictureOf(Viewer& viewer);

/// What the viewer's user is shown at once: slow motion, the game, a replay that differs; one line each.
std::vector<std::string> notices(const Viewer& viewer);

/// Writes the report: frames, pictures, penetration, moves, game, hand and camera, as JSON.
void writeViewerReport(std::ostream& stream, const Viewer& viewer);

}  // namespace springtower
