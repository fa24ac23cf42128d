#include "apps/viewer/view/state.h"

#include "apps/common/interruption.h"
#include "apps/common/json_values.h"
#include "apps/viewer/view/fall.h"
#include "core/error.h"
#include "core/version.h"
#include "solver/metrics/measures.h"

#include <cmath>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <ostream>
#include <utility>

namespace springtower {
namespace {

constexpr std::uint64_t kMeasureEvery = 6;

void keepBar(Viewer& viewer, const StageTimes& before) {
  FrameBar& bar = viewer.bars[viewer.bar];
  bar = {};
  for (std::size_t i = 0; i < kStages; ++i) {
    bar.stage_ms[i] = static_cast<float>(1e3 * (viewer.session.simulation.stageTimes.seconds[i] - before.seconds[i]));
  }
  bar.frame_ms = static_cast<float>(viewer.session.frame_ms);
  viewer.bar = (viewer.bar + 1) % kBars;
}

void measure(Viewer& viewer) {
  const Session& session = viewer.session;
  const ParticleArray& position = session.simulation.state.position;
  if (!viewer.watch.measures || session.frame % kMeasureEvery != 0) return;
  viewer.watch.mostMove_m = std::max(viewer.watch.mostMove_m, largestCornerMove(viewer.start, position));
  const Penetration found = maxPenetration(position, session.scene.floor, viewer.workspace, session.simulation.model.fixed);
  if (found.depth <= viewer.watch.deepest.depth) return;
  viewer.watch.deepest = found;
  viewer.watch.deepestTime_s = session.simulation.time_s;
}

void stepOnce(Viewer& viewer) {
  if (interrupted()) return;  // the play ends with the frame before
  Session& session = viewer.session;
  if (!viewer.replay) leadHand(viewer.controls, session, viewer.limit_n);
  viewer.heldOnce = viewer.heldOnce || viewer.controls.hand.block != kFloor;
  FrameInput input{viewer.controls.hand, viewer.tuning};
  if (viewer.replay) {
    const std::optional<FrameInput> recorded = nextInput(*viewer.replay, session);
    if (recorded) {
      input = *recorded;
      viewer.tuning = input.tuning;
    }
  }
  const std::uint64_t before = session.frame;
  const StageTimes timesBefore = session.simulation.stageTimes;
  try {
    step(session, input);
  } catch (const InputError& error) {  // a tuning that does not fit the scene
    viewer.message = error.what();
    if (viewer.replay) {
      viewer.replay->refused = fmt::format("frame {} of the recording cannot be played: {}", session.frame + 1, error.what());
      viewer.message = viewer.replay->refused;
    }
    viewer.tuning = session.tuning;
    viewer.paused = true;
    return;
  }
  if (session.frame == before && session.failure.empty()) return;  // the search that it began with was ended
  ++viewer.watch.frames;
  if (viewer.mode == Mode::play) viewer.poses.add(session.simulation.state.position);
  keepBar(viewer, timesBefore);
  if (viewer.replay) compare(*viewer.replay, session);
  if (!session.failure.empty()) {
    ++viewer.watch.failures;
    viewer.message = session.failure;
    viewer.paused = true;
    letGo(viewer.controls);
    return;
  }
  measure(viewer);
}

// A message goes when it has been read; while it is paused it says why, and stays.
void fadeMessage(Viewer& viewer, double elapsed_s) {
  viewer.messageAge_s = viewer.message == viewer.lastMessage && !viewer.paused ? viewer.messageAge_s + elapsed_s : 0.0;
  if (viewer.messageAge_s > kMessage_s) viewer.message.clear();
  viewer.lastMessage = viewer.message;
}

// The table is as large as the scene at its start needs, with room for what falls off; what blocks darken on it is found anew.
void layTable(const Viewer& viewer, Picture& picture) {
  constexpr double kLeast_m = 0.55;
  constexpr double kRoom = 2.6;  // its radius, of the scene's
  constexpr double kDarkened_m = 0.7;
  Camera whole;
  showAll(whole, viewer.start);
  const double radius = 0.5 * whole.distance * whole.fieldOfView;
  picture.table = Vec3(whole.target.x(), whole.target.y(), 0.0);
  picture.tableRadius = std::max(kLeast_m, kRoom * radius);
  picture.nearby = nearbyOf(viewer.shown);
  picture.floorOpen = floorOpenness(picture.nearby, picture.table, std::max(kDarkened_m, 2.5 * radius));
}

}  // namespace

Viewer::Viewer(SceneChoice given, const Tuning& wanted)
    : choice(std::move(given)),
      tuning(wanted),
      session(withTuning(sceneOf(choice), wanted), choice.players),
      start(session.simulation.state.position) {
  showAll(controls.camera, start);
  between(session, 1.0, shown);
}

void advance(Viewer& viewer, double elapsed_s) {
  const double frame_s = viewer.session.scene.settings.frame_s;
  int frames = 0;
  const bool waits = followFall(viewer, elapsed_s);
  if (waits || viewer.paused || viewer.fresh) {
    viewer.pacer.waiting_s = 0.0;
    if (!waits && viewer.paused) frames = std::exchange(viewer.once, false) ? 1 : 0;
    if (!waits && !viewer.paused) viewer.fresh = false;
  } else {
    frames = viewer.pacer.due(elapsed_s, frame_s, viewer.session.frame_ms);
  }
  for (int i = 0; i < frames; ++i) stepOnce(viewer);
  fadeMessage(viewer, elapsed_s);
  moveCamera(viewer.controls, viewer.session, elapsed_s);
  updateHover(viewer.controls, viewer.session);
}

namespace {

// What is left of the play so far, gone.
void clearPlay(Viewer& viewer) {
  viewer.message.clear();
  viewer.replay.reset();
  endFall(viewer);
  viewer.tower.known = viewer.hovered.known = false;
  if (viewer.mode == Mode::replay) viewer.mode = Mode::play;
  viewer.pacer.waiting_s = 0.0;
  letGo(viewer.controls);
}

}  // namespace

void again(Viewer& viewer) {
  const bool same = viewer.tuning == viewer.session.keyframes.front().tuning;
  if (!same || viewer.choice.name.ends_with(".toml")) return restart(viewer, SceneChoice(viewer.choice));
  startAgain(viewer.session);
  clearPlay(viewer);
}

void restart(Viewer& viewer, const SceneChoice& choice) {
  try {
    const Scene scene = sceneOf(choice);
    const bool another = choice.name != viewer.choice.name;
    Session next(withTuning(scene, viewer.tuning), choice.players);
    next.searchGoesOn = viewer.session.searchGoesOn;
    next.runSearch = viewer.session.runSearch;
    viewer.session = std::move(next);
    viewer.choice = choice;
    viewer.start = viewer.session.simulation.state.position;
    viewer.fresh = true;
    if (another) showAll(viewer.controls.camera, viewer.start);
    clearPlay(viewer);
  } catch (const InputError& error) {
    viewer.message = error.what();
  }
}

void travel(Viewer& viewer, std::uint64_t frame) {
  if (frame < viewer.session.forgotten || frame > lastLogged(viewer.session)) return;
  letGo(viewer.controls);
  endFall(viewer);
  goTo(viewer.session, frame);
  viewer.tuning = viewer.session.tuning;
  viewer.paused = true;
  viewer.message.clear();
}

void undo(Viewer& viewer) {
  const std::optional<std::uint64_t> frame = undoFrame(viewer.session);
  if (!frame) {
    viewer.message = "there is no move to take back";
    return;
  }
  travel(viewer, *frame);
  viewer.paused = false;
  viewer.message = "the last move is taken back";
}

void startReplay(Viewer& viewer) {
  if (!viewer.replay) viewer.replay = Replay{{viewer.choice, viewer.session.log}, {}, viewer.session.forgotten};
  seek(viewer, 0);
  viewer.paused = false;
  viewer.mode = Mode::replay;
}

void playOn(Viewer& viewer) {
  viewer.replay.reset();
  viewer.paused = false;
  viewer.mode = Mode::play;
}

void seek(Viewer& viewer, std::uint64_t frame) {
  Session& session = viewer.session;
  if (viewer.replay) {
    const std::vector<LoggedFrame>& frames = viewer.replay->recording.frames;
    const std::uint64_t known = lastLogged(session) - viewer.replay->begin;
    if (frames.size() > known)
      session.log.insert(session.log.end(), frames.begin() + static_cast<std::ptrdiff_t>(known), frames.end());
  }
  travel(viewer, std::clamp(frame, session.forgotten, lastLogged(session)));
}

void setMode(Viewer& viewer, Mode mode) {
  if (mode == viewer.mode) return;
  if (viewer.fall.stage != FallStage::none && viewer.fall.stage != FallStage::stopped) skipFall(viewer);
  if (mode == Mode::replay) return startReplay(viewer);
  if (viewer.mode == Mode::replay) playOn(viewer);
  viewer.mode = mode;
}

bool showsMargin(const Viewer& viewer) {
  const Session& session = viewer.session;
  return viewer.mode == Mode::play && session.scene.floor && session.game.phase != Phase::over && session.failure.empty();
}

void followStatics(Viewer& viewer, bool waits) {
  constexpr std::uint64_t kAgainTower = 20;
  constexpr std::uint64_t kAgainBlock = 60;
  const Session& session = viewer.session;
  const auto& hover = viewer.controls.hover;
  if (hover && (viewer.mode == Mode::play || viewer.overlay == Overlay::hints))
    followStatics(viewer.hovered, session, hover->block, kAgainBlock, waits);
  if (showsMargin(viewer)) followStatics(viewer.tower, session, viewer.controls.hand.block, kAgainTower, waits);
}

Picture pictureOf(Viewer& viewer) {
  const Session& session = viewer.session;
  const Controls& controls = viewer.controls;
  const bool past = showsPast(viewer.fall);
  if (past) {
    pastPoses(viewer, viewer.shown);
  } else {
    between(session, viewer.paused ? 1.0 : viewer.pacer.share(session.scene.settings.frame_s), viewer.shown);
  }
  Picture picture;
  picture.floor = session.scene.floor;
  picture.grid = viewer.mode == Mode::lab;
  const BlockId selected = viewer.fall.stage != FallStage::none ? viewer.fall.cause
                           : controls.hover                     ? controls.hover->block
                                                                : controls.guide.block;
  picture.highlighted = selected == kFloor ? -1 : static_cast<std::int32_t>(selected);
  blockMesh(viewer.shown, blockColours(session, viewer.overlay).colour, picture.blocks);
  layTable(viewer, picture);
  if (showsMargin(viewer) && viewer.tower.known) addMargin(viewer.start, viewer.tower.margin, picture.ground);
  if (past) return picture;
  if (viewer.arrows) addContactArrows(session, viewer.controls.camera, picture.marks);
  addHand(session, viewer.controls.hand, viewer.shown, viewer.controls.camera, picture.marks);
  addGuide(session, viewer.controls.guide, viewer.controls.hand, viewer.controls.camera, picture.marks);
  return picture;
}

void writeViewerReport(std::ostream& stream, const Viewer& viewer) {
  using Json = nlohmann::ordered_json;
  const Session& session = viewer.session;
  const Watch& watch = viewer.watch;
  const Camera& camera = viewer.controls.camera;
  const ParticleArray& position = session.simulation.state.position;
  bool finite = true;
  for (const auto& values : position.component) {
    for (const double value : values) finite = finite && std::isfinite(value);
  }
  Json json = {{"version", kVersion},
               {"scene", viewer.choice.name},
               {"frames", session.frame},
               {"frames_stepped", watch.frames},
               {"pictures", watch.pictures},
               {"first_picture_s", watch.firstPicture_s},
               {"first_frame_s", watch.firstFrame_s},
               {"finite", finite},
               {"divergences", watch.failures},
               {"interrupted", watch.interrupted},
               {"max_penetration_all_mm", 1e3 * watch.deepest.depth},
               {"max_penetration_time_s", watch.deepestTime_s},
               {"most_move_mm", 1e3 * std::max(watch.mostMove_m, largestCornerMove(viewer.start, position))},
               {"moves", session.game.moves},
               {"game", describe(session.game)},
               {"held_block", static_cast<int>(viewer.controls.hand.block)},
               {"grip_n", session.gripForce.force.norm()},
               {"camera",
                {{"target_m", {camera.target.x(), camera.target.y(), camera.target.z()}},
                 {"azimuth", camera.azimuth},
                 {"elevation", camera.elevation},
                 {"distance_m", camera.distance},
                 {"field_of_view", camera.fieldOfView}}},
               {"state_hash", fmt::format("{:016x}", stateHash(session.simulation))}};
  const Layout& layout = viewer.layout;
  const auto rect = [](const Rect& r) { return Json{r.x, r.y, r.width, r.height}; };
  json["mode"] = kModeNames[static_cast<std::size_t>(viewer.mode)];
  json["layout"] = {{"window", {viewer.window.width, viewer.window.height}},
                    {"notices", rect(layout.notices)},
                    {"bar", rect(layout.bar)},
                    {"legend", rect(layout.legend)},
                    {"lab", rect(layout.lab)},
                    {"card", rect(layout.card)},
                    {"words", rect(layout.words)}};
  json["replay_differs_in_frame"] = viewer.replay && viewer.replay->differs ? Json(*viewer.replay->differs) : Json(nullptr);
  json["replay_refused"] = viewer.replay && !viewer.replay->refused.empty() ? Json(viewer.replay->refused) : Json(nullptr);
  stream << jsonText(json, 2) << '\n';
}

}  // namespace springtower
