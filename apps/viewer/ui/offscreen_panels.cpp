#include "apps/viewer/ui/offscreen_panels.h"

#include "apps/viewer/ui/style.h"

#include <backends/imgui_impl_opengl3.h>
#include <imgui.h>

namespace springtower {
namespace {

void drawPointer(const ImVec2& at) {
  constexpr float kLength = 1.2F;  // of a line's height
  const float size = kLength * ImGui::GetFontSize();
  ImDrawList& draw = *ImGui::GetForegroundDrawList();
  const ImVec2 low{at.x, at.y + size};
  const ImVec2 side{at.x + 0.7F * size, at.y + 0.7F * size};
  draw.AddTriangleFilled(at, side, low, IM_COL32(255, 255, 255, 255));
  draw.AddTriangle(at, side, low, IM_COL32(20, 22, 26, 255), 1.5F);
}

}  // namespace

OffscreenPanels::OffscreenPanels(const SceneChoice& choice, float scale) : draft_(choice) {
  ImGui::CreateContext();
  ImGui::GetIO().IniFilename = nullptr;
  ImGui_ImplOpenGL3_Init("#version 330 core");
  useStyle(scale, 1.0F);
}

OffscreenPanels::~OffscreenPanels() {
  ImGui_ImplOpenGL3_Shutdown();
  ImGui::DestroyContext();
}

void OffscreenPanels::draw(Viewer& viewer, const Viewport& viewport, const std::optional<Eigen::Vector2d>& mouse) {
  ImGuiIO& io = ImGui::GetIO();
  io.DisplaySize = {static_cast<float>(viewport.width), static_cast<float>(viewport.height)};
  io.DeltaTime = static_cast<float>(viewer.session.scene.settings.frame_s);
  constexpr float kNowhere = -1e6F;
  io.MousePos = mouse ? ImVec2{static_cast<float>(mouse->x()), static_cast<float>(mouse->y())} : ImVec2{kNowhere, kNowhere};
  ImGui_ImplOpenGL3_NewFrame();
  ImGui::NewFrame();
  drawPanels(viewer, draft_, false);
  if (mouse) drawPointer(io.MousePos);
  ImGui::Render();
  ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
}

}  // namespace springtower
