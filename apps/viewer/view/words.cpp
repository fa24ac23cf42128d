#include "apps/viewer/view/words.h"

#include "apps/viewer/view/fall.h"

#include <algorithm>
#include <fmt/format.h>

namespace springtower {
namespace {

std::optional<Eigen::Vector2d> placeOf(const Viewer& viewer, BlockId block) {
  return seenAt(viewer.controls.camera, viewer.controls.viewport, centre(viewer.shown, index(block)));
}

std::optional<Words> wordsAtHand(const Viewer& viewer) {
  const Session& session = viewer.session;
  const Controls& controls = viewer.controls;
  if (controls.hand.block == kFloor || session.hold == Hold::none) return {};
  const auto at = placeOf(viewer, controls.hand.block);
  if (!at) return {};
  Words words{{fmt::format("{:.2f} N", session.gripForce.force.norm())}, *at, holdColour(session.hold)};
  if (viewer.mode != Mode::play) return words;
  if (controls.guide.lead == Lead::pulling) words.lines.emplace_back("Go on until it is free.");
  if (controls.guide.lead == Lead::carrying) {
    words.lines.emplace_back(controls.guide.landing.fits ? "Fits: let go, and it lies down here." : "Hangs over: it would tip.");
    if (session.game.moves == 0) words.lines.emplace_back("Wheel, Q or E turn it.");
  }
  return words;
}

std::optional<Words> wordsAboutBlock(const Viewer& viewer) {
  const Session& session = viewer.session;
  const bool playing = viewer.mode == Mode::play;
  if (!viewer.controls.hover || (viewer.overlay != Overlay::hints && !playing)) return {};
  const BlockId block = viewer.controls.hover->block;
  Words words{{}, {viewer.controls.x, viewer.controls.y}, {}};
  if (playing && session.game.phase != Phase::over && !mayTake(session.game, block)) {
    words.lines.emplace_back(session.game.phase == Phase::moving
                                 ? fmt::format("Lay down block {} first.", index(session.game.block))
                                 : "Not this one: only from below a full row.");
    return words;
  }
  std::optional<bool> stands;
  const StaticsAnswer& answer = viewer.hovered;
  if (answer.known && answer.without == block) stands = answer.margin && answer.margin->tilt_deg >= 0.0;
  const std::string line = inWords(hints(session.simulation, session.contacts)[index(block)], stands);
  const std::size_t end = std::min(line.find(". "), line.size() - 1) + 1;  // a sentence a line
  words.lines.push_back(line.substr(0, end));
  if (end < line.size()) words.lines.push_back(line.substr(end + 1));
  if (playing && !viewer.heldOnce) words.lines.emplace_back("Press and drag: it comes out.");
  return words;
}

}  // namespace

std::vector<Notice> notices(const Viewer& viewer) {
  std::vector<Notice> lines;
  const bool falls = viewer.fall.stage != FallStage::none;
  const Session& session = viewer.session;
  if (session.game.players > 0 && !falls) lines.push_back({describe(session.game)});
  if (viewer.paused && !falls) lines.push_back({"Paused: space goes on, N steps a frame."});
  const bool isSlow = !viewer.paused && viewer.pacer.slow && viewer.mode != Mode::play;
  if (isSlow)
    lines.push_back({fmt::format("Slow motion: this machine reaches {:.0f} % of the speed set.", 100.0 * viewer.pacer.kept())});
  if (!viewer.paused && viewer.pacer.rate < 1.0) lines.push_back({fmt::format("Slow motion: 1/{:.0f}", 1.0 / viewer.pacer.rate)});
  if (viewer.replay) {
    const std::size_t frames = viewer.replay->recording.frames.size();
    if (session.frame < frames) lines.push_back({fmt::format("Replay: frame {} of {}", session.frame, frames)});
    if (viewer.replay->differs) lines.push_back({fmt::format("The replay differs first in frame {}.", *viewer.replay->differs)});
  }
  if (!viewer.message.empty()) {
    lines.push_back({viewer.message, std::clamp((kMessage_s - viewer.messageAge_s) / kMessageFade_s, 0.0, 1.0)});
  }
  return lines;
}

std::optional<Words> wordsAt(const Viewer& viewer, bool mouseInside) {
  const FallReplay& fall = viewer.fall;
  if (fall.stage != FallStage::none) {
    const auto at = fall.cause == kFloor ? std::nullopt : placeOf(viewer, fall.cause);
    if (!at || fall.stage == FallStage::stopped) return {};
    return Words{{fmt::format("Block {} did it", index(fall.cause))}, *at, {}};
  }
  if (auto words = wordsAtHand(viewer)) return words;
  if (!mouseInside) return {};
  if (auto words = wordsAboutBlock(viewer)) return words;
  const bool isBusy = viewer.controls.left || viewer.controls.right || viewer.controls.middle;
  if (viewer.mode != Mode::play || viewer.heldOnce || isBusy || viewer.session.game.phase == Phase::over) return {};
  return Words{{"Drag a block: it comes out along itself.", "Let go over the top: it lies down.", "Drag here: look round."},
               {viewer.controls.x, viewer.controls.y},
               {}};
}

std::vector<std::string> cardLines(const Viewer& viewer) {
  if (viewer.fall.stage != FallStage::stopped) return {};
  std::vector<std::string> lines = {describe(viewer.session.game)};
  const std::string cause = causeInWords(viewer.session.game);
  if (!cause.empty()) lines.push_back(cause);
  return lines;
}

std::vector<LegendRow> legendRows(const Viewer& viewer) {
  std::vector<LegendRow> rows = legendOf(viewer.overlay, blockColours(viewer.session, viewer.overlay), viewer.arrows);
  if (!showsMargin(viewer) || !viewer.tower.known) return rows;
  const double tilt_deg = viewer.tower.margin ? viewer.tower.margin->tilt_deg : -1.0;
  const Colour colour = marginColour(tilt_deg / kFullMargin_deg);
  rows.push_back({"",
                  {colour},
                  tilt_deg < 0.0 ? "Ring: it cannot stand" : fmt::format("Ring: leans {:.1f}\u00b0 before it falls", tilt_deg)});
  return rows;
}

}  // namespace springtower
