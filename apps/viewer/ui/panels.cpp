#include "apps/viewer/ui/panels.h"

#include "apps/viewer/view/fall.h"
#include "apps/viewer/view/words.h"

#include <algorithm>
#include <fmt/format.h>
#include <imgui.h>
#include <span>

namespace springtower {
namespace {

constexpr ImU32 kGround = IM_COL32(20, 22, 26, 205);
constexpr ImGuiWindowFlags kPlain = ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoNav;

// A button, and what it does.
struct Action {
  std::string label;
  void (*act)(Viewer&, PanelWishes&);
};

ImU32 packed(const Colour& colour, double strength = 1.0) {
  return ImGui::ColorConvertFloat4ToU32({colour[0], colour[1], colour[2], static_cast<float>(strength)});
}

ImU32 white(double strength = 1.0) {
  return packed({1.0F, 1.0F, 1.0F}, strength);
}

float marginWidth() {
  constexpr float kMargin = 0.6F;
  return kMargin * ImGui::GetFontSize();
}

void beginAgain(Viewer& viewer, PanelWishes&) {
  again(viewer);
}

void takeBack(Viewer& viewer, PanelWishes&) {
  undo(viewer);
}

void nextPlayers(Viewer& viewer, PanelWishes&) {
  SceneChoice choice = viewer.choice;
  choice.players = (choice.players + 1) % (kMaxPlayers + 1);
  restart(viewer, choice);
}

std::string playersInWords(int players) {
  return players == 0 ? "Free play" : players == 1 ? "Solo" : fmt::format("{} players", players);
}

std::vector<Action> playActions(const Viewer& viewer) {
  const Game& game = viewer.session.game;
  std::vector<Action> actions = {{"Again", beginAgain}};
  if (game.players > 0) actions.push_back({"Take back", takeBack});
  actions.push_back({viewer.overlay == Overlay::hints ? "No hints" : "Hints",
                     [](Viewer& v, PanelWishes&) { v.overlay = v.overlay == Overlay::hints ? Overlay::wood : Overlay::hints; }});
  const bool begins = game.moves == 0 && game.phase != Phase::moving;
  if (begins) actions.push_back({playersInWords(game.players), nextPlayers});
  actions.push_back({"Replay", [](Viewer& v, PanelWishes&) { setMode(v, Mode::replay); }});
  actions.push_back({"Lab", [](Viewer& v, PanelWishes&) { setMode(v, Mode::lab); }});
  return actions;
}

std::vector<Action> replayActions(const Viewer& viewer) {
  return {{viewer.paused ? "Go on" : "Pause", [](Viewer& v, PanelWishes&) { v.paused = !v.paused; }},
          {viewer.pacer.rate == 1.0 ? "Slow" : "Normal speed",
           [](Viewer& v, PanelWishes&) { v.pacer.rate = nextRate(v.pacer.rate); }},
          {"Play from here", [](Viewer& v, PanelWishes&) { setMode(v, Mode::play); }},
          {"Save", [](Viewer&, PanelWishes& wishes) { wishes.recording = true; }}};
}

std::vector<Action> barActions(const Viewer& viewer) {
  if (viewer.mode == Mode::bare || !cardLines(viewer).empty()) return {};
  if (viewer.mode == Mode::replay) return replayActions(viewer);
  if (viewer.mode == Mode::lab) return {{"Play", [](Viewer& v, PanelWishes&) { setMode(v, Mode::play); }}};
  if (viewer.fall.stage != FallStage::none) return {{"Skip", [](Viewer& v, PanelWishes&) { skipFall(v); }}};
  return playActions(viewer);
}

std::vector<Action> cardActions() {
  return {{"Again", beginAgain},
          {"Take back", takeBack},
          {"Watch", [](Viewer& viewer, PanelWishes&) { watchFall(viewer); }},
          {"Save", [](Viewer&, PanelWishes& wishes) { wishes.recording = true; }}};
}

// The size of a window of its own around so many buttons side by side, with lines above them.
Extent extentOf(std::span<const std::string> lines, std::span<const Action> actions, float beside) {
  if (lines.empty() && actions.empty()) return {};
  const ImGuiStyle& style = ImGui::GetStyle();
  float width = beside;
  for (const Action& action : actions) width += ImGui::CalcTextSize(action.label.c_str()).x + 2.0F * style.FramePadding.x;
  width += style.ItemSpacing.x * static_cast<float>(actions.size() - (beside > 0.0F ? 0 : 1));
  for (const std::string& line : lines) width = std::max(width, ImGui::CalcTextSize(line.c_str()).x);
  const float height = ImGui::GetFrameHeight() + static_cast<float>(lines.size()) * ImGui::GetTextLineHeightWithSpacing();
  return {width + 2.0F * style.WindowPadding.x + 1.0F, height + 2.0F * style.WindowPadding.y};
}

void drawActions(Viewer& viewer, std::span<const Action> actions, PanelWishes& wishes) {
  bool first = true;
  for (const Action& action : actions) {
    if (!first) ImGui::SameLine();
    first = false;
    if (ImGui::Button(action.label.c_str())) action.act(viewer, wishes);
  }
}

void beginPlain(const char* name, const Rect& rect) {
  ImGui::SetNextWindowPos({rect.x, rect.y});
  ImGui::SetNextWindowSize({rect.width, rect.height});
  ImGui::Begin(name, nullptr, kPlain | ImGuiWindowFlags_NoScrollWithMouse);
}

void drawTimeLine(Viewer& viewer, float width) {
  const std::uint64_t played = lastLogged(viewer.session);
  const std::uint64_t frames =
      viewer.replay ? std::max(viewer.replay->begin + viewer.replay->recording.frames.size(), played) : played;
  int frame = static_cast<int>(viewer.session.frame);
  ImGui::SameLine();
  ImGui::SetNextItemWidth(width);
  if (ImGui::SliderInt("##frame", &frame, static_cast<int>(viewer.session.forgotten), static_cast<int>(frames), "Frame %d",
                       ImGuiSliderFlags_AlwaysClamp))
    seek(viewer, static_cast<std::uint64_t>(frame));
}

// Lines of text on a dark ground; the sizes of the lines where they are no wider than `width`.
struct Paragraphs {
  float width;
  std::vector<Extent> sizes;
  Extent all;
};

Paragraphs paragraphsOf(std::span<const Notice> lines, float width) {
  Paragraphs paragraphs{width - 2.0F * marginWidth(), {}, {}};
  for (const Notice& line : lines) {
    const ImVec2 size = ImGui::CalcTextSize(line.text.c_str(), nullptr, false, paragraphs.width);
    paragraphs.sizes.push_back({size.x + 2.0F * marginWidth(), size.y + marginWidth()});
    paragraphs.all.width = std::max(paragraphs.all.width, paragraphs.sizes.back().width);
    paragraphs.all.height += paragraphs.sizes.back().height + 0.5F * marginWidth();
  }
  return paragraphs;
}

void drawNotices(std::span<const Notice> lines, const Paragraphs& paragraphs, const Rect& rect) {
  ImDrawList& draw = *ImGui::GetBackgroundDrawList();
  float y = rect.y;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const Extent& size = paragraphs.sizes[i];
    const float x = rect.x + 0.5F * (rect.width - size.width);
    const auto dark = static_cast<ImU32>(205.0 * lines[i].strength);
    draw.AddRectFilled({x, y}, {x + size.width, y + size.height}, IM_COL32(20, 22, 26, dark), 0.5F * marginWidth());
    draw.AddText(ImGui::GetFont(), ImGui::GetFontSize(), {x + marginWidth(), y + 0.5F * marginWidth()}, white(lines[i].strength),
                 lines[i].text.c_str(), nullptr, paragraphs.width + 1.0F);
    y += size.height + 0.5F * marginWidth();
  }
}

Extent wordsExtent(const Words& words) {
  Extent extent;
  for (const std::string& line : words.lines) {
    extent.width = std::max(extent.width, ImGui::CalcTextSize(line.c_str()).x + 2.0F * marginWidth());
    extent.height += ImGui::GetTextLineHeight();
  }
  extent.height += marginWidth();
  return extent;
}

void drawWords(const Words& words, const Rect& rect) {
  if (isEmpty(rect)) return;
  ImDrawList& draw = *ImGui::GetBackgroundDrawList();
  draw.AddRectFilled({rect.x, rect.y}, {rect.x + rect.width, rect.y + rect.height}, kGround, 0.5F * marginWidth());
  float y = rect.y + 0.5F * marginWidth();
  for (const std::string& line : words.lines) {
    const bool emphasised = words.emphasis && &line == words.lines.data();
    draw.AddText({rect.x + marginWidth(), y}, emphasised ? packed(*words.emphasis) : white(), line.c_str());
    y += ImGui::GetTextLineHeight();
  }
}

float stripWidth(const LegendRow& row) {
  constexpr float kStrip = 6.0F;  // line heights
  return row.colours.empty() ? 0.0F : ImGui::GetFontSize() * (row.colours.size() == 1 ? 1.0F : kStrip);
}

Extent legendExtent(std::span<const LegendRow> rows) {
  if (rows.empty()) return {};
  Extent extent;
  for (const LegendRow& row : rows) {
    const float words = ImGui::CalcTextSize(row.before.c_str()).x + ImGui::CalcTextSize(row.after.c_str()).x;
    extent.width = std::max(extent.width, words + stripWidth(row) + 4.0F * marginWidth());
  }
  extent.height = static_cast<float>(rows.size()) * ImGui::GetTextLineHeightWithSpacing() + marginWidth();
  return extent;
}

void drawLegend(std::span<const LegendRow> rows, const Rect& rect) {
  if (isEmpty(rect)) return;
  ImDrawList& draw = *ImGui::GetBackgroundDrawList();
  draw.AddRectFilled({rect.x, rect.y}, {rect.x + rect.width, rect.y + rect.height}, kGround, 0.5F * marginWidth());
  float y = rect.y + 0.5F * marginWidth() + 0.5F * (ImGui::GetTextLineHeightWithSpacing() - ImGui::GetTextLineHeight());
  for (const LegendRow& row : rows) {
    float x = rect.x + marginWidth();
    if (!row.before.empty()) {
      draw.AddText({x, y}, white(), row.before.c_str());
      x += ImGui::CalcTextSize(row.before.c_str()).x + marginWidth();
    }
    const float part = stripWidth(row) / static_cast<float>(std::max<std::size_t>(row.colours.size(), 1));
    const float low = y + 0.85F * ImGui::GetTextLineHeight();
    for (const Colour& colour : row.colours) {
      draw.AddRectFilled({x, y + 0.15F * ImGui::GetTextLineHeight()}, {x + part + 0.5F, low}, packed(colour));
      x += part;
    }
    draw.AddText({x + marginWidth(), y}, white(), row.after.c_str());
    y += ImGui::GetTextLineHeightWithSpacing();
  }
}

// What stands over the picture now.
struct Parts {
  std::vector<Notice> notices;
  std::optional<Words> words;
  std::vector<LegendRow> legend;
  std::vector<Action> bar;
  std::vector<std::string> card;
};

Parts partsOf(const Viewer& viewer) {
  const ImGuiIO& io = ImGui::GetIO();
  const bool inside = ImGui::IsMousePosValid() && !io.WantCaptureMouse;
  return {notices(viewer), wordsAt(viewer, inside), legendRows(viewer), barActions(viewer), cardLines(viewer)};
}

}  // namespace

PanelWishes drawPanels(Viewer& viewer, LabDraft& draft, bool filming) {
  PanelWishes wishes;
  const ImGuiIO& io = ImGui::GetIO();
  const Parts parts = partsOf(viewer);
  const std::vector<Action> cardButtons = parts.card.empty() ? std::vector<Action>{} : cardActions();
  const float lineWidth = viewer.mode == Mode::replay ? 8.0F * ImGui::GetFontSize() : 0.0F;
  const Extent window{io.DisplaySize.x, io.DisplaySize.y};
  const float lab = viewer.mode == Mode::lab ? std::min(labWidth(), window.width) : 0.0F;
  const Paragraphs paragraphs = paragraphsOf(parts.notices, widthBeside(window, lab, marginWidth()));
  Wanted wanted;
  wanted.notices = paragraphs.all;
  wanted.bar = extentOf({}, parts.bar, lineWidth);
  wanted.legend = legendExtent(parts.legend);
  wanted.lab = {lab, lab > 0.0F ? draft.height : 0.0F};
  wanted.card = extentOf(parts.card, cardButtons, 0.0F);
  Extent at;
  if (parts.words) {
    wanted.words = wordsExtent(*parts.words);
    at = {static_cast<float>(parts.words->at.x()) / io.DisplayFramebufferScale.x,
          static_cast<float>(parts.words->at.y()) / io.DisplayFramebufferScale.y};
  }
  viewer.layout = layoutOf(window, wanted, at, marginWidth());
  viewer.window = window;

  drawNotices(parts.notices, paragraphs, viewer.layout.notices);
  if (parts.words) drawWords(*parts.words, viewer.layout.words);
  drawLegend(parts.legend, viewer.layout.legend);
  if (lab > 0.0F) drawLab(viewer, draft, wishes, filming, viewer.layout.lab);
  if (!parts.bar.empty()) {
    beginPlain("Bar", viewer.layout.bar);
    drawActions(viewer, parts.bar, wishes);
    if (lineWidth > 0.0F) drawTimeLine(viewer, lineWidth);
    ImGui::End();
  }
  if (parts.card.empty()) return wishes;
  beginPlain("Card", viewer.layout.card);
  for (const std::string& line : parts.card) ImGui::TextUnformatted(line.c_str());
  drawActions(viewer, cardButtons, wishes);
  ImGui::End();
  return wishes;
}

}  // namespace springtower
