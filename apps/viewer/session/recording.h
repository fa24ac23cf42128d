#pragma once

#include "apps/viewer/session/session.h"
#include "core/output_file.h"
#include "scenarios/recorded/recording.h"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace springtower {

/// Writes the recording of a session while it goes on, so that a game that is cut short can be played again up to there.
class RecordingWriter {
 public:
  /// The file outlives the writer.
  explicit RecordingWriter(OutputFile& file) : file_(file) {}
  RecordingWriter(const RecordingWriter&) = delete;
  RecordingWriter& operator=(const RecordingWriter&) = delete;

  /// Writes what is new since the last call: call it after every frame. What the session has gone back from and stepped anew is
  /// taken back in the file, and all of it when the scene was chosen anew. A file that cannot be cut is written by `finish`
  /// alone, from a session that forgets nothing. Throws InputError when the disk is full.
  void follow(const SceneChoice& choice, Session& session);

  /// Leaves the frames up to the session's present one, and gives the file its name. Throws InputError.
  void finish(const SceneChoice& choice, Session& session);

 private:
  OutputFile& file_;
  std::string header_;
  std::uint64_t begin_ = 0;           // frames that the session has forgotten, of which ends_ has none
  std::vector<std::uintmax_t> ends_;  // bytes of the file up to the end of frame begin_ (0: the header), and of each one after it
};

/// Steps a session through a recording, frame by frame.
struct Replay {
  Recording recording;
  std::optional<std::uint64_t> differs;  ///< the first frame (from 1, as the session counts) whose state was another
  std::uint64_t begin = 0;               ///< frames of the session before the first of the recording
  std::string refused = {};              ///< why its next frame cannot be played; empty while it can

  /// What it begins with.
  [[nodiscard]] Tuning tuning() const;
};

/// The input of the session's next frame, or empty at the recording's end.
std::optional<FrameInput> nextInput(const Replay& replay, const Session& session);

/// Compares the state that the last frame led to with the recorded one, where its hash was kept.
void compare(Replay& replay, const Session& session);

}  // namespace springtower
