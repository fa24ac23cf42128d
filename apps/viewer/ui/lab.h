#pragma once

#include "apps/viewer/view/layout.h"
#include "apps/viewer/view/state.h"

namespace springtower {

/// What the user chose that needs the window: done by its owner.
struct PanelWishes {
  bool screenshot = false;
  bool film = false;       ///< starts a video, or ends the one that is being recorded
  bool recording = false;  ///< writes what was played so far
};

/// What stands in the lab's panel until it is used.
struct LabDraft {
  explicit LabDraft(const SceneChoice& choice);

  int rows = 18;
  int seed;
  float sigma_mm;  ///< of the heights
  int players;
  float tolerance_um = 0.0F;  ///< while its slider is held
  float height = 1e3F;        ///< of all that stands in it, as last drawn
};

/// How wide the panel is.
float labWidth();

/// Draws the panel of what can be changed and measured into a rectangle, and carries out what the user changes in it. Scrolls
/// where it does not fit.
void drawLab(Viewer& viewer, LabDraft& draft, PanelWishes& wishes, bool filming, const Rect& rect);

/// The next slower rate of simulated time, or real time after the slowest.
double nextRate(double rate);

}  // namespace springtower
