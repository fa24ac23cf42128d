#include "apps/viewer/ui/style.h"

#include <algorithm>
#include <filesystem>
#include <imgui.h>

namespace springtower {
namespace {

// What fontconfig, which cairo needs, brings along on Debian.
constexpr const char* kFontFile = "/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf";

}  // namespace

void useStyle(float contentScale, float windowScale) {
  ImGuiIO& io = ImGui::GetIO();
  io.Fonts->Clear();
  std::error_code unreadable;
  const float size_px = kFont_px * contentScale;
  if (std::filesystem::exists(kFontFile, unreadable)) {
    io.Fonts->AddFontFromFileTTF(kFontFile, size_px);
  } else {
    ImFontConfig config;
    config.SizePixels = size_px;
    io.Fonts->AddFontDefault(&config);
  }
  io.FontGlobalScale = 1.0F / windowScale;
  ImGuiStyle style;
  ImGui::StyleColorsDark(&style);
  style.WindowRounding = 6.0F;
  style.FrameRounding = 4.0F;
  style.GrabRounding = 4.0F;
  style.WindowBorderSize = 0.0F;
  style.FramePadding = {9.0F, 5.0F};
  style.WindowPadding = {10.0F, 10.0F};
  style.Colors[ImGuiCol_WindowBg] = {0.09F, 0.09F, 0.10F, 0.88F};
  style.Colors[ImGuiCol_Button] = {0.24F, 0.26F, 0.29F, 1.0F};
  style.Colors[ImGuiCol_ButtonHovered] = {0.34F, 0.38F, 0.44F, 1.0F};
  style.Colors[ImGuiCol_ButtonActive] = {0.20F, 0.42F, 0.68F, 1.0F};
  style.ScaleAllSizes(contentScale / windowScale);
  ImGui::GetStyle() = style;
}

}  // namespace springtower
