#include "apps/viewer/session/recording.h"

#include <algorithm>

namespace springtower {

void RecordingWriter::follow(const SceneChoice& choice, Session& session) {
  if (!file_.canCut()) return;
  const std::string header = headerLine(choice);
  if (header != header_) {
    if (!ends_.empty()) file_.cutTo(0);
    file_.stream() << header;
    header_ = header;
    ends_ = {header.size()};
  } else if (ends_.size() - 1 > session.logKept) {
    ends_.resize(session.logKept + 1);
    file_.cutTo(ends_.back());
  }
  for (std::size_t i = ends_.size() - 1; i < session.log.size(); ++i) {
    const std::string line = frameLine(session.log, i);
    file_.stream() << line;
    ends_.push_back(ends_.back() + line.size());
  }
  session.logKept = session.log.size();
  file_.flushEverySecond();
}

void RecordingWriter::finish(const SceneChoice& choice, Session& session) {
  const std::size_t frames = std::min<std::size_t>(session.frame, session.log.size());
  if (file_.canCut()) {
    follow(choice, session);
    if (frames + 1 < ends_.size()) {
      ends_.resize(frames + 1);
      file_.cutTo(ends_.back());
    }
  } else {
    writeRecording(file_.stream(),
                   {choice, {session.log.begin(), session.log.begin() + static_cast<std::ptrdiff_t>(frames)}, {}});
  }
  file_.commit();
}

std::optional<FrameInput> nextInput(const Replay& replay, const Session& session) {
  if (session.frame >= replay.recording.frames.size()) return {};
  return replay.recording.frames[session.frame].input;
}

void compare(Replay& replay, const Session& session) {
  if (replay.differs || session.frame == 0 || session.frame > replay.recording.frames.size()) return;
  const std::optional<std::uint64_t>& recorded = replay.recording.frames[session.frame - 1].hash;
  const bool same = session.failure.empty() && (!recorded || stateHash(session.simulation) == *recorded);
  if (!same) replay.differs = session.failure.empty() ? session.frame : session.frame + 1;
}

}  // namespace springtower
