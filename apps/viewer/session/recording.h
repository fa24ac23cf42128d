#pragma once

#include "apps/viewer/session/session.h"
#include "core/scene/scene.h"

#include <iosfwd>
#include <string>
#include <vector>

namespace springtower {

/// What heights of real blocks vary by, m: the default of the viewer, as in an even tower no block is loose.
inline constexpr double kUsualSigma_m = 2e-4;

/// A scene as the user chose it, from which it can be made again.
struct SceneChoice {
  std::string name = "tower:18";
  TowerOptions options;
  int players = 0;
};

/// The scene that was chosen. Throws InputError.
Scene sceneOf(const SceneChoice& choice);

/// Input of a session from its first frame on.
struct Recording {
  SceneChoice choice;
  std::vector<LoggedFrame> frames;
};

/// Writes a recording, one JSON object a line: first the scene, then each frame with the hash of the state it led to, the hand
/// where it holds a block, and the tuning where it changed. Numbers are written so that they read back as they were.
void writeRecording(std::ostream& stream, const Recording& recording);

/// Reads one. Throws InputError naming the file and the line.
Recording readRecording(const std::string& path);

/// Steps a session through a recording, frame by frame.
struct Replay {
  Recording recording;
  std::optional<std::uint64_t> differs;  ///< the first frame (from 1, as the session counts) whose state was another
};

/// The input of the session's next frame, or empty at the recording's end.
std::optional<FrameInput> nextInput(const Replay& replay, const Session& session);

/// Compares the state that the last frame led to with the recorded one.
void compare(Replay& replay, const Session& session);

}  // namespace springtower
