#pragma once

#include "apps/viewer/ui/panels.h"

#include <optional>

namespace springtower {

/// Words and panels over pictures that no window shows, with a drawn pointer. An OpenGL context has to be current for its whole
/// life.
class OffscreenPanels {
 public:
  /// `scale`: of words and buttons.
  OffscreenPanels(const SceneChoice& choice, float scale);
  OffscreenPanels(const OffscreenPanels&) = delete;
  OffscreenPanels& operator=(const OffscreenPanels&) = delete;
  ~OffscreenPanels();
  /// Draws them over what the bound framebuffer shows; `mouse`: where the pointer is, pixels.
  void draw(Viewer& viewer, const Viewport& viewport, const std::optional<Eigen::Vector2d>& mouse);

 private:
  LabDraft draft_;
};

}  // namespace springtower
