#pragma once

#include "apps/viewer/session/session.h"
#include "core/output_file.h"
#include "core/scene/scene.h"

#include <cstdint>
#include <iosfwd>
#include <optional>
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
  std::string missing = {};  ///< what a file that was broken off lacks, in a line; empty for a whole one
};

/// Writes a recording, one JSON object a line: first the scene, then each frame with the hash of the state it led to, the hand
/// where it holds a block, and the tuning where it changed. Numbers are written so that they read back as they were.
void writeRecording(std::ostream& stream, const Recording& recording);

/// Writes the recording of a session while it goes on, so that a game that is cut short can be played again up to there.
class RecordingWriter {
 public:
  /// The file outlives the writer.
  explicit RecordingWriter(OutputFile& file) : file_(file) {}
  RecordingWriter(const RecordingWriter&) = delete;
  RecordingWriter& operator=(const RecordingWriter&) = delete;

  /// Writes what is new since the last call: call it after every frame. What the session has gone back from and stepped anew is
  /// taken back in the file, and all of it when the scene was chosen anew. A file that cannot be cut is written by `finish`
  /// alone. Throws InputError when the disk is full.
  void follow(const SceneChoice& choice, Session& session);

  /// Leaves the frames up to the session's present one, and gives the file its name. Throws InputError.
  void finish(const SceneChoice& choice, Session& session);

 private:
  OutputFile& file_;
  std::string header_;
  std::vector<std::uintmax_t> ends_;  // bytes of the file up to the end of the header, and of each frame
};

/// Reads one. Of a file that was broken off in the middle of a line, as a process that is killed leaves it, the whole lines are
/// read, and `missing` says so. Throws InputError naming the file, the line and the key, what was found and what is allowed:
/// every number is within the limits of what it sets, blocks are the scene's and may move, orientations are unit quaternions.
Recording readRecording(const std::string& path);

/// Steps a session through a recording, frame by frame.
struct Replay {
  Recording recording;
  std::optional<std::uint64_t> differs;  ///< the first frame (from 1, as the session counts) whose state was another
  std::string refused = {};              ///< why its next frame cannot be played; empty while it can
};

/// The input of the session's next frame, or empty at the recording's end.
std::optional<FrameInput> nextInput(const Replay& replay, const Session& session);

/// Compares the state that the last frame led to with the recorded one.
void compare(Replay& replay, const Session& session);

}  // namespace springtower
