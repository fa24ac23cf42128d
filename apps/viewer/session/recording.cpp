#include "apps/viewer/session/recording.h"

#include <algorithm>
#include <limits>

namespace springtower {

void RecordingWriter::follow(const SceneChoice& choice, Session& session) {
  if (!file_.canCut()) {
    session.mostLogged = std::numeric_limits<std::size_t>::max();
    return;
  }
  const std::string header = headerLine(choice);
  if (header != header_ || session.logKept < begin_) {  // another scene, or the same from its start
    if (!ends_.empty()) file_.cutTo(0);
    file_.stream() << header;
    header_ = header;
    begin_ = 0;
    ends_ = {header.size()};
  } else if (begin_ + ends_.size() - 1 > session.logKept) {
    ends_.resize(session.logKept - begin_ + 1);
    file_.cutTo(ends_.back());
  }
  for (std::uint64_t frame = begin_ + ends_.size() - 1; frame < lastLogged(session); ++frame) {
    const std::string line = frameLine(session.log, frame - session.forgotten);
    file_.stream() << line;
    ends_.push_back(ends_.back() + line.size());
  }
  session.logKept = lastLogged(session);
  ends_.erase(ends_.begin(), ends_.begin() + static_cast<std::ptrdiff_t>(session.forgotten - begin_));
  begin_ = session.forgotten;
  file_.flushEverySecond();
}

void RecordingWriter::finish(const SceneChoice& choice, Session& session) {
  const std::size_t frames = std::min<std::uint64_t>(session.frame, lastLogged(session)) - session.forgotten;
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

Tuning Replay::tuning() const {
  return recording.frames.empty() ? tuningOf(sceneOf(recording.choice)) : recording.frames.front().input.tuning;
}

std::optional<FrameInput> nextInput(const Replay& replay, const Session& session) {
  if (session.frame >= replay.begin + replay.recording.frames.size()) return {};
  return replay.recording.frames[session.frame - replay.begin].input;
}

void compare(Replay& replay, const Session& session) {
  if (replay.differs || session.frame <= replay.begin || session.frame > replay.begin + replay.recording.frames.size()) return;
  const std::optional<std::uint64_t>& recorded = replay.recording.frames[session.frame - replay.begin - 1].hash;
  const bool same = session.failure.empty() && (!recorded || stateHash(session.simulation) == *recorded);
  if (!same) replay.differs = session.failure.empty() ? session.frame : session.frame + 1;
}

}  // namespace springtower
