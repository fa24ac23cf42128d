#include "apps/viewer/session/session.h"

#include "apps/common/interruption.h"
#include "core/error.h"
#include "solver/frame/inputs.h"
#include "solver/frame/prepare.h"
#include "solver/hand/played_frame.h"
#include "solver/world/memory_use.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <utility>

namespace springtower {
namespace {

constexpr std::uint64_t kKeyEvery = 30;  // frames between keyframes
constexpr double kPictureTime_s = 0.1;
constexpr double kPaceMemory_s = 1.0;
constexpr double kKept = 0.95;

bool needsRebuild(const Tuning& a, const Tuning& b) {
  return a.method != b.method || a.tolerance_m != b.tolerance_m;
}

// Another method or stiffness is another simulation, which takes the blocks over as they lie and move; contacts start anew.
// Before the first frame it begins as its scene does, as in a session that has had this tuning from the start. Returns the one
// before.
Simulation rebuild(Session& session, const Tuning& tuning) {
  Simulation next(withTuning(session.scene, tuning));
  if (session.frame > 0) next.state = session.simulation.state;
  session.tuning = tuning;
  return std::exchange(session.simulation, std::move(next));
}

// Returns the simulation before, where another one had to take its place.
std::optional<Simulation> tune(Session& session, const Tuning& tuning) {
  if (tuning == session.tuning) return {};
  // Friction decides which equilibrium a scene begins in.
  if (needsRebuild(tuning, session.tuning) || (session.frame == 0 && tuning.friction != session.tuning.friction))
    return rebuild(session, tuning);
  setFriction(session.simulation, tuning.friction, tuning.friction);
  setSleep(session.simulation, tuning.sleep);
  session.tuning = tuning;
  return {};
}

// Removes the keyframe whose neighbours are nearest to each other, over how long ago they were, until all fit into their bytes.
void thinOut(Session& session) {
  std::deque<Keyframe>& keys = session.keyframes;
  std::size_t bytes = 0;
  for (const Keyframe& key : keys) bytes += key.bytes;
  const std::size_t kept = session.forgotten > 0 ? 2 : 1;
  while (bytes > kKeyframeBytes && keys.size() > kLeastKeyframes) {
    std::size_t best = kept;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t i = kept; i + 1 < keys.size(); ++i) {
      const auto gap = static_cast<double>(keys[i + 1].frame - keys[i - 1].frame);
      const double share = gap / static_cast<double>(session.frame - keys[i - 1].frame);
      if (share >= least) continue;
      least = share;
      best = i;
    }
    bytes -= keys[best].bytes;
    keys.erase(keys.begin() + static_cast<std::ptrdiff_t>(best));
  }
}

void keep(Session& session) {
  // After going back, frames that have their keyframe already are stepped again.
  if (!session.keyframes.empty() && session.keyframes.back().frame >= session.frame) return;
  // A snapshot is a part of what the simulation holds.
  const std::size_t bytes = memoryUse(session.simulation).total();
  session.keyframes.push_back(
      {session.frame, session.tuning, session.grip, session.game, bytes, takeSnapshot(session.simulation)});
  thinOut(session);
}

// A signal ends the search for an equilibrium, and so does closing the window.
PrepareOptions untilEnded(const Session& session) {
  return {.goesOn = [&session](const PrepareProgress&) {
    return !interrupted() && (!session.searchGoesOn || session.searchGoesOn());
  }};
}

// Forgets the oldest quarter of a log that is too long, up to the next keyframe.
void forget(Session& session) {
  if (session.log.size() <= session.mostLogged) return;
  std::deque<Keyframe>& keys = session.keyframes;
  const std::uint64_t least = session.forgotten + (session.log.size() + 3) / 4;
  const auto next = std::find_if(keys.begin() + 1, keys.end(), [&](const Keyframe& key) { return key.frame >= least; });
  if (next == keys.end()) return;
  session.log.erase(session.log.begin(), session.log.begin() + static_cast<std::ptrdiff_t>(next->frame - session.forgotten));
  session.forgotten = next->frame;
  keys.erase(keys.begin() + 1, next);
}

// The last keyframe at or before a frame; the first one is of frame 0.
const Keyframe& keyBefore(const Session& session, std::uint64_t frame) {
  const auto after = std::upper_bound(session.keyframes.begin(), session.keyframes.end(), frame,
                                      [](std::uint64_t f, const Keyframe& key) { return f < key.frame; });
  return *(after - 1);
}

void restore(Session& session, const Keyframe& key) {
  if (needsRebuild(key.tuning, session.tuning)) rebuild(session, key.tuning);
  session.tuning = key.tuning;
  restoreSnapshot(session.simulation, *key.snapshot);  // friction and sleep are in it
  session.frame = key.frame;
  session.grip = key.grip;
  session.game = key.game;
  session.gripForce = {};
  session.hold = Hold::none;
  session.before = session.simulation.state.position;
  session.contacts = contactForces(session.simulation);
}

// Steps a frame; false where the search for an equilibrium that it began with was ended.
bool playFrame(Session& session, const Hand& hand) {
  bool played = false;
  const auto frame = [&] { played = stepPlayed(hand, session.grip, session.contacts, session.simulation, untilEnded(session)); };
  if (session.runSearch && !isPrepared(session.simulation)) {
    session.runSearch(frame);
  } else {
    frame();
  }
  return played;
}

// One frame of physics and game, without the past. Returns the input that acted: without a hand that the game does not allow.
// Empty, and all as before, where the search for the equilibrium that a scene, method or tolerance begins with was ended early.
std::optional<FrameInput> advance(Session& session, FrameInput input) {
  const auto start = std::chrono::steady_clock::now();
  Simulation& simulation = session.simulation;
  const Tuning tuningBefore = session.tuning;
  const Grip gripBefore = session.grip;
  std::optional<Simulation> simulationBefore = tune(session, input.tuning);
  session.before = simulation.state.position;
  if (!mayTake(session.game, input.hand.block)) input.hand = {};
  const BlockId held = input.hand.block;
  if (!playFrame(session, input.hand)) {
    if (!simulationBefore) {  // in the first frame
      restore(session, session.keyframes.front());
      return {};
    }
    simulation = std::move(*simulationBefore);
    session.tuning = tuningBefore;
    session.grip = gripBefore;
    return {};
  }
  session.gripForce = gripForce(simulation);
  session.hold = held == kFloor ? Hold::none : holdOf(session.contacts, held);
  ++session.frame;
  const bool turnEnded = followGame(session.game, simulation, held, session.frame);
  session.frame_ms = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
  if (turnEnded && session.turns.back() < session.frame) session.turns.push_back(session.frame);
  if (turnEnded || session.frame % kKeyEvery == 0) keep(session);
  return input;
}

}  // namespace

Session::Session(const Scene& given, int players)
    : scene(given),
      tuning(tuningOf(given)),
      simulation(withTuning(given, tuning)),
      before(simulation.state.position),
      contacts(contactForces(simulation)),
      game(newGame(simulation, players, 0)),
      turns{0} {
  keep(*this);
}

void prepareStart(Session& session) {
  if (session.frame > 0 || !session.failure.empty() || isPrepared(session.simulation)) return;
  try {
    prepare(session.simulation, untilEnded(session));
  } catch (const DivergenceError&) {
    return;  // the first frame finds it again, and says so
  }
  session.before = session.simulation.state.position;
  session.contacts = contactForces(session.simulation);
  session.keyframes.clear();
  keep(session);
}

void startAgain(Session& session) {
  restore(session, session.keyframes.front());
  session.failure.clear();
  session.gripForce = {};
  session.log.clear();
  session.forgotten = 0;
  session.logKept = 0;
  session.turns = {0};
  session.keyframes.resize(1);
}

void step(Session& session, const FrameInput& input) {
  if (!session.failure.empty()) return;
  while (session.keyframes.back().frame > session.frame) session.keyframes.pop_back();
  while (session.turns.back() > session.frame) session.turns.pop_back();
  std::optional<FrameInput> acted;
  try {
    acted = advance(session, input);
  } catch (const DivergenceError& error) {
    session.failure = error.what();
    return;
  }
  if (!acted) return;
  // A future that was gone back from ends here.
  session.log.resize(session.frame - session.forgotten);
  session.logKept = std::min(session.logKept, session.frame - 1);
  session.log.back() = {*acted, stateHash(session.simulation)};
  forget(session);
}

std::uint64_t lastLogged(const Session& session) {
  return session.forgotten + session.log.size();
}

void goTo(Session& session, std::uint64_t frame) {
  const Keyframe key = keyBefore(session, frame);
  if (frame < session.frame || key.frame > session.frame || !session.failure.empty()) restore(session, key);
  session.failure.clear();
  while (session.frame < frame && advance(session, session.log[session.frame - session.forgotten].input)) {
  }
}

std::optional<std::uint64_t> undoFrame(const Session& session) {
  const Game& game = session.game;
  if (game.players == 0) return {};
  // What falls before this turn's player has touched anything falls by the turn before.
  const bool fellBefore = game.phase == Phase::over && game.held == kFloor && game.laid != kFloor;
  std::uint64_t frame = game.turnFrame;
  if (game.phase == Phase::choose || fellBefore) {
    const auto thisTurn = std::lower_bound(session.turns.begin(), session.turns.end(), game.turnFrame);
    if (thisTurn == session.turns.begin()) return {};
    frame = *(thisTurn - 1);
  }
  if (frame < session.forgotten) return {};
  return frame;
}

void between(const Session& session, double share, ParticleArray& position) {
  const ParticleArray& now = session.simulation.state.position;
  position.resize(now.blockCount());
  for (std::size_t a = 0; a < 3; ++a) {
    for (std::size_t i = 0; i < now.component[a].size(); ++i) {
      const double start = session.before.component[a][i];
      position.component[a][i] = start + share * (now.component[a][i] - start);
    }
  }
}

int Pacer::due(double elapsed_s, double frame_s, double frame_ms) {
  const double wanted = rate * elapsed_s;
  waiting_s += wanted;
  const int most = std::max(1, static_cast<int>(kPictureTime_s / std::max(1e-3 * frame_ms, 1e-6)));
  const int frames = std::min(static_cast<int>(waiting_s / frame_s), most);
  waiting_s -= frames * frame_s;
  waiting_s = std::min(waiting_s, frame_s * (1.0 - 1e-9));  // what is left over is dropped: slow motion
  const double fade = std::exp(-elapsed_s / kPaceMemory_s);
  wanted_s = fade * wanted_s + wanted;
  done_s = fade * done_s + frames * frame_s;
  slow = wanted_s > 0.2 * rate && done_s < kKept * wanted_s;
  return frames;
}

}  // namespace springtower
