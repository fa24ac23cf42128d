#pragma once

#include "core/block.h"
#include "core/hand.h"
#include "core/method.h"
#include "core/scene/scene.h"
#include "core/settings.h"

#include <cstddef>
#include <cstdint>
#include <iosfwd>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace springtower {

// Games that a hand played, frame by frame: what the viewer writes (apps/viewer/session) and whoever plays it again reads.

/// What heights of real blocks vary by, m: the default of the viewer, as in an even tower no block is loose.
inline constexpr double kUsualSigma_m = 2e-4;

inline constexpr int kMaxPlayers = 4;

/// A scene as the user chose it, from which it can be made again.
struct SceneChoice {
  std::string name = "tower:18";
  TowerOptions options;
  int players = 0;  ///< of the game, up to kMaxPlayers; 0: no game, any block may be taken
};

/// The scene that was chosen. Throws InputError.
Scene sceneOf(const SceneChoice& choice);

/// What a user may change while the scene runs.
struct Tuning {
  Method method = Method::semiImplicitEuler;
  Sleep sleep = Sleep::on;
  double tolerance_m = kBlockTolerance_m;
  double friction = 0.4;
  bool operator==(const Tuning&) const = default;
};

/// All that acts on one frame from outside: the input that a recording keeps.
struct FrameInput {
  Hand hand;
  Tuning tuning;
};

/// One frame of the past: what acted on it, and the state it led to.
struct LoggedFrame {
  FrameInput input;
  std::optional<std::uint64_t> hash = {};  ///< stateHash after the frame; empty where it was not kept
};

/// The tuning that a scene starts with.
Tuning tuningOf(const Scene& scene);

/// The scene with a tuning put over it.
Scene withTuning(Scene scene, const Tuning& tuning);

/// Input of a game from its first frame on.
struct Recording {
  SceneChoice choice;
  std::vector<LoggedFrame> frames;
  std::string missing = {};  ///< what a file that was broken off lacks, in a line; empty for a whole one
};

/// Writes a recording, one JSON object a line: first the scene, then each frame with the hash of the state it led to where that
/// is known, the hand where it holds a block, and the tuning where it changed. Numbers are written so that they read back as they
/// were.
void writeRecording(std::ostream& stream, const Recording& recording);

/// Its first line, with the line end.
std::string headerLine(const SceneChoice& choice);

/// The line of a frame (from 0), with the line end: the tuning is in it where it is another than in the frame before.
std::string frameLine(const std::vector<LoggedFrame>& frames, std::size_t frame);

/// Reads one. Of a file that was broken off in the middle of a line, as a process that is killed leaves it, the whole lines are
/// read, and `missing` says so. Throws InputError naming the file, the line and the key, what is expected and what it got:
/// every number is within the limits of what it sets, blocks are the scene's and may move, orientations are unit quaternions.
Recording readRecording(const std::string& path);

/// The same of its lines, without line ends. `name`: what messages call it.
Recording recordingOf(std::span<const std::string_view> lines, const std::string& name);

}  // namespace springtower
