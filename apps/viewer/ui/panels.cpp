#include "apps/viewer/ui/panels.h"

#include "core/limits.h"

#include <algorithm>
#include <charconv>
#include <chrono>
#include <fmt/format.h>
#include <imgui.h>

namespace springtower {
namespace {

constexpr std::array<ImU32, kStages> kStageColours = {
    IM_COL32(86, 120, 190, 255), IM_COL32(120, 170, 220, 255), IM_COL32(150, 110, 190, 255), IM_COL32(230, 180, 80, 255),
    IM_COL32(220, 110, 70, 255), IM_COL32(110, 180, 110, 255), IM_COL32(160, 160, 160, 255)};
constexpr std::array<double, 4> kRates = {1.0, 0.5, 0.25, 0.1};

void text(const std::string& line) {
  ImGui::TextUnformatted(line.c_str());
}

ImU32 packed(const Colour& colour) {
  return ImGui::ColorConvertFloat4ToU32({colour[0], colour[1], colour[2], 1.0F});
}

void runPanel(Viewer& viewer) {
  if (ImGui::Button(viewer.paused ? "resume" : "pause")) viewer.paused = !viewer.paused;
  ImGui::SameLine();
  if (ImGui::Button("step")) viewer.paused = viewer.once = true;
  ImGui::SameLine();
  if (ImGui::Button("reset")) restart(viewer, viewer.choice);
  ImGui::SameLine();
  if (ImGui::Button("undo")) undo(viewer);
  ImGui::SameLine();
  const std::string speed = fmt::format("1/{:.0f} speed", 1.0 / viewer.pacer.rate);
  if (ImGui::Button(viewer.pacer.rate == 1.0 ? "slow motion" : speed.c_str())) viewer.pacer.rate = nextRate(viewer.pacer.rate);
  int frame = static_cast<int>(viewer.session.frame);
  if (ImGui::SliderInt("frame", &frame, 0, static_cast<int>(viewer.session.log.size()), "%d", ImGuiSliderFlags_AlwaysClamp)) {
    travel(viewer, static_cast<std::uint64_t>(frame));
  }
}

void towerPanel(Viewer& viewer, PanelDraft& draft) {
  constexpr int kMaxSliderRows = 72;
  ImGui::SliderInt("rows", &draft.rows, 1, kMaxSliderRows);
  ImGui::SliderFloat("heights vary, mm", &draft.sigma_mm, 0.0F, 1.0F, "%.2f");
  ImGui::InputInt("seed", &draft.seed);
  ImGui::SliderInt("players", &draft.players, 0, kMaxPlayers, draft.players == 0 ? "no game" : "%d");
  bool build = ImGui::Button("new tower");
  ImGui::SameLine();
  if (ImGui::Button("next seed")) {
    ++draft.seed;
    build = true;
  }
  if (!build) return;
  SceneChoice next = viewer.choice;
  next.name = fmt::format("tower:{}", draft.rows);
  next.players = draft.players;
  next.options.seed = static_cast<std::uint64_t>(std::max(draft.seed, 0));
  next.options.heightsSigma_m = 1e-3 * static_cast<double>(draft.sigma_mm);
  restart(viewer, next);
}

void physicsPanel(Viewer& viewer, PanelDraft& draft) {
  Tuning& tuning = viewer.tuning;
  const Simulation& simulation = viewer.session.simulation;
  constexpr std::array kMethods = {Method::semiImplicitEuler, Method::midpoint, Method::rungeKutta4, Method::implicit,
                                   Method::report};
  constexpr std::array kSleeps = {Sleep::on, Sleep::off, Sleep::report};
  if (ImGui::BeginCombo("method", std::string(nameOf(tuning.method)).c_str())) {
    for (const Method method : kMethods) {
      if (ImGui::Selectable(std::string(nameOf(method)).c_str(), method == tuning.method)) tuning.method = method;
    }
    ImGui::EndCombo();
  }
  if (ImGui::BeginCombo("sleep", std::string(nameOf(tuning.sleep)).c_str())) {
    for (const Sleep sleep : kSleeps) {
      if (ImGui::Selectable(std::string(nameOf(sleep)).c_str(), sleep == tuning.sleep)) tuning.sleep = sleep;
    }
    ImGui::EndCombo();
  }
  // Another stiffness is another simulation, so the slider counts when it is let go.
  ImGui::SliderFloat("tolerance, um", &draft.tolerance_um, 5.0F, 1000.0F, "%.0f", ImGuiSliderFlags_Logarithmic);
  if (ImGui::IsItemDeactivatedAfterEdit()) tuning.tolerance_m = 1e-6 * static_cast<double>(draft.tolerance_um);
  if (!ImGui::IsItemActive()) draft.tolerance_um = static_cast<float>(1e6 * tuning.tolerance_m);
  auto friction = static_cast<float>(tuning.friction);
  if (ImGui::SliderFloat("friction", &friction, 0.0F, 1.0F, "%.2f")) tuning.friction = static_cast<double>(friction);
  text(fmt::format("{} steps a frame, contacts {:.1f} kN/m", simulation.substeps, 1e-3 * largestStiffness(simulation.stiffness)));
}

void handPanel(Viewer& viewer) {
  auto limit = static_cast<float>(viewer.limit_n);
  if (ImGui::SliderFloat("strength, N", &limit, 0.5F, 20.0F, "%.1f")) viewer.limit_n = static_cast<double>(limit);
  const Session& session = viewer.session;
  if (session.hold == Hold::none) {
    text("nothing held");
    return;
  }
  constexpr std::array<const char*, 4> kHolds = {"", "free", "sticks", "slips"};
  text(fmt::format("{:.2f} N, {}{}", session.gripForce.force.norm(), kHolds[static_cast<std::size_t>(session.hold)],
                   session.gripForce.limited ? ", at its limit" : ""));
}

void showPanel(Viewer& viewer) {
  if (ImGui::BeginCombo("colour by", std::string(kOverlayNames[static_cast<std::size_t>(viewer.overlay)]).c_str())) {
    for (std::size_t i = 0; i < kOverlays; ++i) {
      const auto overlay = static_cast<Overlay>(i);
      if (ImGui::Selectable(std::string(kOverlayNames[i]).c_str(), overlay == viewer.overlay)) viewer.overlay = overlay;
    }
    ImGui::EndCombo();
  }
  ImGui::Checkbox("contact forces", &viewer.arrows);
  const BlockColours colours = blockColours(viewer.session, viewer.overlay);
  if (colours.unit.empty()) return;
  const ImVec2 at = ImGui::GetCursorScreenPos();
  constexpr int kParts = 32;
  constexpr float kWidth = 200.0F;
  constexpr float kHeight = 12.0F;
  for (int i = 0; i < kParts; ++i) {
    const float left = at.x + kWidth * static_cast<float>(i) / kParts;
    const ImU32 colour = packed(colourMap(viewer.overlay, i / (kParts - 1.0)));
    ImGui::GetWindowDrawList()->AddRectFilled({left, at.y}, {left + kWidth / kParts, at.y + kHeight}, colour);
  }
  ImGui::Dummy({kWidth, kHeight});
  ImGui::SameLine();
  text(fmt::format("0 to {:.3g} {}", colours.most, colours.unit));
}

void timePanel(const Viewer& viewer) {
  constexpr float kWidth = 2.0F * 120.0F;
  constexpr float kHeight = 70.0F;
  const float full_ms = 2e3F * static_cast<float>(viewer.session.scene.settings.frame_s);
  const ImVec2 at = ImGui::GetCursorScreenPos();
  ImDrawList& draw = *ImGui::GetWindowDrawList();
  draw.AddRectFilled(at, {at.x + kWidth, at.y + kHeight}, IM_COL32(20, 22, 26, 200));
  for (std::size_t i = 0; i < kBars; ++i) {
    const FrameBar& bar = viewer.bars[(viewer.bar + i) % kBars];
    const float left = at.x + kWidth * static_cast<float>(i) / static_cast<float>(kBars);
    const float right = left + kWidth / static_cast<float>(kBars);
    float bottom = at.y + kHeight;
    const auto add = [&](float ms, ImU32 colour) {
      const float top = std::max(bottom - kHeight * std::max(ms, 0.0F) / full_ms, at.y);
      draw.AddRectFilled({left, top}, {right, bottom}, colour);
      bottom = top;
    };
    float stages_ms = 0.0F;
    for (std::size_t s = 0; s < kStages; ++s) {
      add(bar.stage_ms[s], kStageColours[s]);
      stages_ms += bar.stage_ms[s];
    }
    add(bar.frame_ms - stages_ms, IM_COL32(90, 90, 90, 255));
  }
  const float half = at.y + 0.5F * kHeight;
  draw.AddLine({at.x, half}, {at.x + kWidth, half}, IM_COL32(255, 255, 255, 120));  // one frame's time
  ImGui::Dummy({kWidth, kHeight});
  const FrameBar& last = viewer.bars[(viewer.bar + kBars - 1) % kBars];
  text(fmt::format("{:.2f} ms a frame (line: {:.1f}), picture {:.1f} ms", static_cast<double>(last.frame_ms),
                   0.5 * static_cast<double>(full_ms), static_cast<double>(viewer.picture_ms)));
  for (std::size_t s = 0; s < kStages; ++s) {
    ImGui::PushStyleColor(ImGuiCol_Text, kStageColours[s]);
    text(fmt::format("{:<18}{:7.3f} ms", kStageNames[s], static_cast<double>(last.stage_ms[s])));
    ImGui::PopStyleColor();
  }
  const Simulation& simulation = viewer.session.simulation;
  const Counters& counters = simulation.counters;
  const auto asleep = std::count(simulation.asleep.begin(), simulation.asleep.end(), std::uint8_t{1});
  text(fmt::format("blocks {}, asleep {}, contacts {}", simulation.asleep.size(), asleep, viewer.session.contacts.size()));
  text(fmt::format("steps {}, cubic tests {}, hits {}", counters.steps, counters.cubicTests, counters.cubicHits));
  text(fmt::format("contacts created {}, penetrating {}", counters.contactsCreated, counters.contactsCreatedPenetrating));
  const std::string woken = wakesInWords(simulation.wakes);
  if (!woken.empty()) ImGui::TextWrapped("%s", ("woken: " + woken).c_str());
}

void helpPanel() {
  text(
      "drag a block: pull it out along itself, then carry it\n"
      "let go: it lies down where the outline is\n"
      "wheel, Q E: a quarter turn\n"
      "drag beside it, arrow keys: go round; wheel: nearer, farther\n"
      "shift: all six axes, right drag along the view, W S, A D\n"
      "space pause, N one frame, R reset, T slow motion\n"
      "backspace takes the last move back, [ ] one frame back, forth\n"
      "O colour by, F contact forces, tab panels, P screenshot\n"
      "V record video, I writes what is seen and all poses, escape ends");
}

void drawNotices(const Viewer& viewer) {
  const ImVec2 size = ImGui::GetIO().DisplaySize;
  ImDrawList& draw = *ImGui::GetForegroundDrawList();
  float y = 12.0F;
  for (const std::string& line : notices(viewer)) {
    const ImVec2 extent = ImGui::CalcTextSize(line.c_str());
    const float x = 0.5F * (size.x - extent.x);
    draw.AddRectFilled({x - 8.0F, y - 3.0F}, {x + extent.x + 8.0F, y + extent.y + 3.0F}, IM_COL32(20, 22, 26, 190), 4.0F);
    draw.AddText({x, y}, IM_COL32(255, 255, 255, 255), line.c_str());
    y += extent.y + 9.0F;
  }
}

// Text beside a block, on a dark ground.
void drawBeside(const Viewer& viewer, std::size_t block, const std::string& line, ImU32 colour) {
  const auto at = seenAt(viewer.controls.camera, viewer.controls.viewport, centre(viewer.shown, block));
  if (!at) return;
  const ImVec2 scale = ImGui::GetIO().DisplayFramebufferScale;
  const ImVec2 extent = ImGui::CalcTextSize(line.c_str());
  const float right = ImGui::GetIO().DisplaySize.x - extent.x - 8.0F;  // all of it stays inside the window
  const ImVec2 corner{std::max(8.0F, std::min(static_cast<float>(at->x()) / scale.x + 18.0F, right)),
                      static_cast<float>(at->y()) / scale.y - 30.0F};
  ImDrawList& draw = *ImGui::GetForegroundDrawList();
  draw.AddRectFilled({corner.x - 5.0F, corner.y - 3.0F}, {corner.x + extent.x + 5.0F, corner.y + extent.y + 3.0F},
                     IM_COL32(20, 22, 26, 210), 4.0F);
  draw.AddText(corner, colour, line.c_str());
}

void drawHandForce(const Viewer& viewer) {
  const Session& session = viewer.session;
  const BlockId held = viewer.controls.hand.block;
  if (held == kFloor || session.hold == Hold::none) return;
  drawBeside(viewer, index(held), fmt::format("{:.2f} N", session.gripForce.force.norm()), packed(holdColour(session.hold)));
}

// Computes the statics without the block under the mouse, again once a second as the tower changes.
void askStatics(const Viewer& viewer, BlockId block, StaticsHint& statics) {
  constexpr std::uint64_t kAgain = 60;
  const Session& session = viewer.session;
  if (statics.coming.valid()) {
    if (statics.coming.wait_for(std::chrono::seconds(0)) != std::future_status::ready) return;
    statics.tilt_deg = statics.coming.get();
  }
  const bool fresh = statics.block == block && statics.frame <= session.frame && session.frame < statics.frame + kAgain;
  if (fresh) return;
  if (statics.block != block) statics.tilt_deg.reset();
  statics.block = block;
  statics.frame = session.frame;
  auto question = withoutBlock(session.simulation, session.contacts, block);
  if (!question) return;
  statics.coming = std::async(std::launch::async, [asked = std::move(*question)] { return tiltBorne(asked); });
}

void drawHint(const Viewer& viewer, StaticsHint& statics) {
  if (viewer.overlay != Overlay::hints || !viewer.controls.hover) return;
  const BlockId block = viewer.controls.hover->block;
  askStatics(viewer, block, statics);
  std::optional<bool> stands;
  if (statics.block == block && statics.tilt_deg) stands = *statics.tilt_deg >= 0.0;
  const Hint hint = hints(viewer.session.simulation, viewer.session.contacts)[index(block)];
  drawBeside(viewer, index(block), inWords(hint, stands), IM_COL32(255, 255, 255, 255));
}

}  // namespace

double nextRate(double rate) {
  const auto* at = std::find(kRates.begin(), kRates.end(), rate);
  return at == kRates.end() || at + 1 == kRates.end() ? kRates.front() : *(at + 1);
}

PanelDraft::PanelDraft(const SceneChoice& choice)
    : seed(static_cast<int>(choice.options.seed.value_or(1))),
      sigma_mm(static_cast<float>(1e3 * choice.options.heightsSigma_m.value_or(kUsualSigma_m))),
      players(choice.players) {
  const std::string_view name = choice.name;
  constexpr std::string_view kTower = "tower:";
  // Anything else leaves the rows as they are.
  if (name.starts_with(kTower)) std::from_chars(name.data() + kTower.size(), name.data() + name.size(), rows);
}

PanelWishes drawPanels(Viewer& viewer, PanelDraft& draft, bool filming) {
  PanelWishes wishes;
  drawNotices(viewer);
  drawHandForce(viewer);
  drawHint(viewer, draft.statics);
  if (!viewer.panels) return wishes;
  ImGui::SetNextWindowPos({10.0F, 10.0F}, ImGuiCond_FirstUseEver);
  ImGui::Begin("Springtower", nullptr, ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoNav);
  ImGui::PushItemWidth(160.0F);
  runPanel(viewer);
  const auto section = [](const char* name, bool open) {
    return ImGui::CollapsingHeader(name, open ? ImGuiTreeNodeFlags_DefaultOpen : 0);
  };
  if (section("hand", true)) handPanel(viewer);
  if (section("show", true)) showPanel(viewer);
  if (section("time", true)) timePanel(viewer);
  if (section("tower and game", false)) towerPanel(viewer, draft);
  if (section("physics", false)) physicsPanel(viewer, draft);
  if (section("files", false)) {
    wishes.screenshot = ImGui::Button("screenshot");
    ImGui::SameLine();
    wishes.film = ImGui::Button(filming ? "end video" : "record video");
    ImGui::SameLine();
    wishes.recording = ImGui::Button("recording");
  }
  if (section("mouse and keys", false)) helpPanel();
  ImGui::PopItemWidth();
  ImGui::End();
  return wishes;
}

}  // namespace springtower
