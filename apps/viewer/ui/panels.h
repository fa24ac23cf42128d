#pragma once

#include "apps/viewer/ui/lab.h"

namespace springtower {

/// Draws all words, buttons and panels over the picture with Dear ImGui, and carries out what the user does with them. Call
/// between ImGui::NewFrame and ImGui::Render, after pictureOf. `filming`: whether a video is being recorded. Where the parts lie
/// is then in `viewer.layout`.
PanelWishes drawPanels(Viewer& viewer, LabDraft& draft, bool filming);

}  // namespace springtower
