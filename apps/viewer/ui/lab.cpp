#include "apps/viewer/ui/lab.h"

#include "core/limits.h"

#include <algorithm>
#include <charconv>
#include <fmt/format.h>
#include <imgui.h>

namespace springtower {
namespace {

constexpr std::array<ImU32, kStages> kStageColours = {
    IM_COL32(86, 120, 190, 255), IM_COL32(120, 170, 220, 255), IM_COL32(150, 110, 190, 255), IM_COL32(230, 180, 80, 255),
    IM_COL32(220, 110, 70, 255), IM_COL32(110, 180, 110, 255), IM_COL32(160, 160, 160, 255)};
constexpr std::array<double, 4> kRates = {1.0, 0.5, 0.25, 0.1};

void text(const std::string& line) {
  ImGui::TextWrapped("%s", line.c_str());
}

void runPanel(Viewer& viewer) {
  if (ImGui::Button(viewer.paused ? "Go on" : "Pause")) viewer.paused = !viewer.paused;
  ImGui::SameLine();
  if (ImGui::Button("Step")) viewer.paused = viewer.once = true;
  ImGui::SameLine();
  if (ImGui::Button("Reset")) again(viewer);
  ImGui::SameLine();
  if (ImGui::Button("Undo")) undo(viewer);
  ImGui::SameLine();
  const std::string speed = fmt::format("1/{:.0f} speed", 1.0 / viewer.pacer.rate);
  if (ImGui::Button(viewer.pacer.rate == 1.0 ? "Slow" : speed.c_str())) viewer.pacer.rate = nextRate(viewer.pacer.rate);
  int frame = static_cast<int>(viewer.session.frame);
  const int first = static_cast<int>(viewer.session.forgotten);
  if (ImGui::SliderInt("Frame", &frame, first, static_cast<int>(lastLogged(viewer.session)), "%d",
                       ImGuiSliderFlags_AlwaysClamp)) {
    travel(viewer, static_cast<std::uint64_t>(frame));
  }
}

void towerPanel(Viewer& viewer, LabDraft& draft) {
  constexpr int kMaxSliderRows = 72;
  ImGui::SliderInt("Rows", &draft.rows, 1, kMaxSliderRows);
  ImGui::SliderFloat("Heights vary, mm", &draft.sigma_mm, 0.0F, 1.0F, "%.2f");
  ImGui::InputInt("Seed", &draft.seed);
  ImGui::SliderInt("Players", &draft.players, 0, kMaxPlayers, draft.players == 0 ? "No game" : "%d");
  bool build = ImGui::Button("New tower");
  ImGui::SameLine();
  if (ImGui::Button("Next seed")) {
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

void physicsPanel(Viewer& viewer, LabDraft& draft) {
  Tuning& tuning = viewer.tuning;
  const Simulation& simulation = viewer.session.simulation;
  constexpr std::array kMethods = {Method::semiImplicitEuler, Method::midpoint, Method::rungeKutta4, Method::implicit,
                                   Method::report};
  constexpr std::array kSleeps = {Sleep::on, Sleep::off, Sleep::report};
  if (ImGui::BeginCombo("Method", std::string(nameOf(tuning.method)).c_str())) {
    for (const Method method : kMethods) {
      if (ImGui::Selectable(std::string(nameOf(method)).c_str(), method == tuning.method)) tuning.method = method;
    }
    ImGui::EndCombo();
  }
  if (ImGui::BeginCombo("Sleep", std::string(nameOf(tuning.sleep)).c_str())) {
    for (const Sleep sleep : kSleeps) {
      if (ImGui::Selectable(std::string(nameOf(sleep)).c_str(), sleep == tuning.sleep)) tuning.sleep = sleep;
    }
    ImGui::EndCombo();
  }
  // Another stiffness is another simulation, so the slider counts when it is let go.
  ImGui::SliderFloat("Tolerance, \u00b5m", &draft.tolerance_um, 5.0F, 1000.0F, "%.0f", ImGuiSliderFlags_Logarithmic);
  if (ImGui::IsItemDeactivatedAfterEdit()) tuning.tolerance_m = 1e-6 * static_cast<double>(draft.tolerance_um);
  if (!ImGui::IsItemActive()) draft.tolerance_um = static_cast<float>(1e6 * tuning.tolerance_m);
  auto friction = static_cast<float>(tuning.friction);
  if (ImGui::SliderFloat("Friction", &friction, 0.0F, 1.0F, "%.2f")) tuning.friction = static_cast<double>(friction);
  text(fmt::format("{} steps a frame, contacts {:.1f} kN/m", simulation.substeps, 1e-3 * largestStiffness(simulation.stiffness)));
}

void handPanel(Viewer& viewer) {
  auto limit = static_cast<float>(viewer.limit_n);
  if (ImGui::SliderFloat("Strength, N", &limit, 0.5F, 20.0F, "%.1f")) viewer.limit_n = static_cast<double>(limit);
  const Session& session = viewer.session;
  if (session.hold == Hold::none) {
    text("Nothing held");
    return;
  }
  constexpr std::array<const char*, 4> kHolds = {"", "free", "sticks", "slips"};
  text(fmt::format("{:.2f} N, {}{}", session.gripForce.force.norm(), kHolds[static_cast<std::size_t>(session.hold)],
                   session.gripForce.limited ? ", at its limit" : ""));
}

void showPanel(Viewer& viewer) {
  if (ImGui::BeginCombo("Colour by", std::string(kOverlayNames[static_cast<std::size_t>(viewer.overlay)]).c_str())) {
    for (std::size_t i = 0; i < kOverlays; ++i) {
      const auto overlay = static_cast<Overlay>(i);
      if (ImGui::Selectable(std::string(kOverlayNames[i]).c_str(), overlay == viewer.overlay)) viewer.overlay = overlay;
    }
    ImGui::EndCombo();
  }
  ImGui::Checkbox("Contact forces", &viewer.arrows);
}

void timePanel(const Viewer& viewer) {
  const float width = 14.0F * ImGui::GetFontSize();
  const float height = 4.0F * ImGui::GetFontSize();
  const float full_ms = 2e3F * static_cast<float>(viewer.session.scene.settings.frame_s);
  const ImVec2 at = ImGui::GetCursorScreenPos();
  ImDrawList& draw = *ImGui::GetWindowDrawList();
  draw.AddRectFilled(at, {at.x + width, at.y + height}, IM_COL32(20, 22, 26, 200));
  for (std::size_t i = 0; i < kBars; ++i) {
    const FrameBar& bar = viewer.bars[(viewer.bar + i) % kBars];
    const float left = at.x + width * static_cast<float>(i) / static_cast<float>(kBars);
    const float right = left + width / static_cast<float>(kBars);
    float bottom = at.y + height;
    const auto add = [&](float ms, ImU32 colour) {
      const float top = std::max(bottom - height * std::max(ms, 0.0F) / full_ms, at.y);
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
  const float half = at.y + 0.5F * height;
  draw.AddLine({at.x, half}, {at.x + width, half}, IM_COL32(255, 255, 255, 120));  // one frame's time
  ImGui::Dummy({width, height});
  const FrameBar& last = viewer.bars[(viewer.bar + kBars - 1) % kBars];
  text(fmt::format("{:.2f} ms a frame (line: {:.1f}), picture {:.1f} ms", static_cast<double>(last.frame_ms),
                   0.5 * static_cast<double>(full_ms), static_cast<double>(viewer.picture_ms)));
  for (std::size_t s = 0; s < kStages; ++s) {
    ImGui::PushStyleColor(ImGuiCol_Text, kStageColours[s]);
    text(fmt::format("{:7.3f} ms  {}", static_cast<double>(last.stage_ms[s]), kStageNames[s]));
    ImGui::PopStyleColor();
  }
  const Simulation& simulation = viewer.session.simulation;
  const Counters& counters = simulation.counters;
  const auto asleep = std::count(simulation.asleep.begin(), simulation.asleep.end(), std::uint8_t{1});
  text(fmt::format("Blocks {}, asleep {}, contacts {}", simulation.asleep.size(), asleep, viewer.session.contacts.size()));
  text(fmt::format("Steps {}, cubic tests {}, hits {}", counters.steps, counters.cubicTests, counters.cubicHits));
  text(fmt::format("Contacts created {}, penetrating {}", counters.contactsCreated, counters.contactsCreatedPenetrating));
  const std::string woken = wakesInWords(simulation.wakes);
  if (!woken.empty()) ImGui::TextWrapped("%s", ("Woken: " + woken).c_str());
}

void helpPanel() {
  ImGui::TextWrapped(
      "Drag a block: pull it out along itself, then carry it.\n"
      "Let go: it lies down where the outline is.\n"
      "Wheel, Q, E: a quarter turn.\n"
      "Drag beside it, arrow keys: go round; wheel: nearer, farther.\n"
      "Shift: all six axes, right drag along the view, W S, A D.\n"
      "Space: pause. N: one frame. R: reset. T: slow motion.\n"
      "Backspace takes the last move back, [ ] one frame back, forth.\n"
      "O: colour by. F: contact forces. Tab: play. P: screenshot.\n"
      "V: record video. I: writes what is seen and all poses. Escape ends.");
}

}  // namespace

double nextRate(double rate) {
  const auto* at = std::find(kRates.begin(), kRates.end(), rate);
  return at == kRates.end() || at + 1 == kRates.end() ? kRates.front() : *(at + 1);
}

LabDraft::LabDraft(const SceneChoice& choice)
    : seed(static_cast<int>(choice.options.seed.value_or(1))),
      sigma_mm(static_cast<float>(1e3 * choice.options.heightsSigma_m.value_or(kUsualSigma_m))),
      players(choice.players) {
  const std::string_view name = choice.name;
  constexpr std::string_view kTower = "tower:";
  // Anything else leaves the rows as they are.
  if (name.starts_with(kTower)) std::from_chars(name.data() + kTower.size(), name.data() + name.size(), rows);
}

float labWidth() {
  constexpr float kWidth = 23.0F;
  return kWidth * ImGui::GetFontSize();
}

void drawLab(Viewer& viewer, LabDraft& draft, PanelWishes& wishes, bool filming, const Rect& rect) {
  ImGui::SetNextWindowPos({rect.x, rect.y});
  ImGui::SetNextWindowSize({rect.width, rect.height});
  ImGui::Begin("Lab", nullptr,
               ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoNav);
  ImGui::PushItemWidth(10.0F * ImGui::GetFontSize());
  runPanel(viewer);
  const auto section = [](const char* name, bool open) {
    return ImGui::CollapsingHeader(name, open ? ImGuiTreeNodeFlags_DefaultOpen : 0);
  };
  if (section("Hand", true)) handPanel(viewer);
  if (section("Show", true)) showPanel(viewer);
  if (section("Time", true)) timePanel(viewer);
  if (section("Tower and game", false)) towerPanel(viewer, draft);
  if (section("Physics", false)) physicsPanel(viewer, draft);
  if (section("Files", false)) {
    wishes.screenshot = ImGui::Button("Screenshot");
    ImGui::SameLine();
    wishes.film = ImGui::Button(filming ? "End video" : "Record video");
    ImGui::SameLine();
    wishes.recording = ImGui::Button("Recording") || wishes.recording;
  }
  if (section("Mouse and keys", false)) helpPanel();
  ImGui::PopItemWidth();
  draft.height = ImGui::GetCursorPosY() + ImGui::GetStyle().WindowPadding.y;
  ImGui::End();
}

}  // namespace springtower
