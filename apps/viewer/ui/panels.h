#pragma once

#include "apps/viewer/view/state.h"

#include <cstdint>
#include <future>
#include <optional>

namespace springtower {

/// What the user chose in the panels that needs the window: done by its owner.
struct PanelWishes {
  bool screenshot = false;
  bool film = false;       ///< starts a video, or ends the one that is being recorded
  bool recording = false;  ///< writes what was played so far
};

/// What statics says of the tower without the block under the mouse; found beside the drawing, which does not wait for it.
struct StaticsHint {
  BlockId block = kFloor;
  std::uint64_t frame = 0;  ///< when it was started
  std::future<double> coming;
  std::optional<double> tilt_deg;  ///< see tiltBorne
};

/// What stands in the panels until it is used.
struct PanelDraft {
  explicit PanelDraft(const SceneChoice& choice);

  int rows = 18;
  int seed;
  float sigma_mm;  ///< of the heights
  int players;
  float tolerance_um = 0.0F;  ///< while its slider is held
  StaticsHint statics;
};

/// Draws panels, notices and the hand's force with Dear ImGui, and carries out what the user changes in them. Call between
/// ImGui::NewFrame and ImGui::Render. `filming`: whether a video is being recorded.
PanelWishes drawPanels(Viewer& viewer, PanelDraft& draft, bool filming);

/// The next slower rate of simulated time, or real time after the slowest.
double nextRate(double rate);

}  // namespace springtower
