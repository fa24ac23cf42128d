// Recordings of the viewer: what is none is refused, and what is one can be played, gone back in and written again.
#include "apps/viewer/session/recording.h"

#include "core/error.h"
#include "tests/fuzz/fuzz.h"

#include <algorithm>
#include <sstream>

namespace springtower {
namespace {

constexpr std::uint64_t kMostFrames = 4;

bool takesLong(const Session& session) {
  return session.simulation.fixedSubsteps > kMostSubsteps || session.simulation.substeps > kMostSubsteps;
}

void play(const Recording& recording) {
  const Scene scene = sceneOf(recording.choice);
  if (scene.blocks.size() > kMostBlocks) return;
  Session session(scene, recording.choice.players);
  Replay replay{recording, {}};
  while (session.frame < kMostFrames && session.failure.empty() && !takesLong(session)) {
    const std::optional<FrameInput> input = nextInput(replay, session);
    if (!input) break;
    step(session, *input);
    compare(replay, session);
    if (session.failure.empty()) requireFinite(session.simulation);
  }
  if (!session.failure.empty()) requireMessage(session.failure);
  const std::uint64_t end = session.log.size();
  if (end == 0) return;
  const std::optional<std::uint64_t> hash = session.log[end - 1].hash;
  goTo(session, end / 2);
  goTo(session, end);
  requireThat(stateHash(session.simulation) == hash, "going back and forth leads to the same state");
  if (const std::optional<std::uint64_t> frame = undoFrame(session)) requireThat(*frame <= end, "undo goes back");
}

// Whole files alone: what is missing from others is not written again.
void requireSameWritten(const Recording& recording) {
  std::ostringstream first;
  writeRecording(first, recording);
  const InputFile file(first.str());
  std::ostringstream second;
  writeRecording(second, readRecording(file.path()));
  requireThat(first.str() == second.str(), "a recording reads back as it was written");
}

void readAndPlay(std::string_view text) {
  const InputFile file(text);
  Recording recording;
  try {
    recording = readRecording(file.path());
  } catch (const InputError& error) {
    requireMessage(error.what(), file.path());
    return;
  }
  requireSameWritten(recording);
  try {
    play(recording);
  } catch (const InputError& error) {
    requireMessage(error.what());
  } catch (const DivergenceError& error) {  // of what was gone back to
    requireMessage(error.what());
  }
}

}  // namespace
}  // namespace springtower

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  springtower::readAndPlay(springtower::textOf(data, size));
  return 0;
}
