// The part of window.h that needs no window.
#include "apps/common/interruption.h"
#include "apps/viewer/app/window.h"
#include "apps/viewer/io/output.h"
#include "apps/viewer/ui/offscreen_panels.h"
#include "apps/viewer/view/fall.h"

#include <cmath>
#include <filesystem>
#include <fmt/format.h>
#include <memory>

namespace springtower {

namespace {

void act(Viewer& viewer, MouseAct what) {
  switch (what) {
    case MouseAct::none:
      return;
    case MouseAct::press:
    case MouseAct::release:
      return buttonChanged(viewer.controls, viewer.session, Button::left, what == MouseAct::press);
    case MouseAct::hints:
      viewer.overlay = viewer.overlay == Overlay::hints ? Overlay::wood : Overlay::hints;
      return;
    case MouseAct::skip:
      return skipFall(viewer);
  }
}

// The next frame by its number; or, with a mouse, 1/60 s as it passes in the window.
void stepPicture(Viewer& viewer, const HeadlessRun& run, int picture) {
  if (run.mouse.empty()) {
    viewer.paused = true;
    viewer.once = true;
    return advance(viewer, 0.0);
  }
  const auto number = static_cast<std::uint64_t>(picture);
  const Eigen::Vector2d at = mouseAt(run.mouse, number);
  pointerMoved(viewer.controls, viewer.session, at.x(), at.y());
  for (const MouseAct what : mouseActs(run.mouse, number)) act(viewer, what);
  viewer.session.frame_ms = 0.0;  // a film shows all frames, however long they take
  advance(viewer, viewer.session.scene.settings.frame_s);
}

void drawPicture(Viewer& viewer, Renderer& renderer, OffscreenPanels* panels, const Viewport& size, const HeadlessRun& run,
                 int picture) {
  followStatics(viewer, true);
  renderer.draw(pictureOf(viewer), viewer.controls.camera, size);
  if (panels == nullptr) return;
  if (run.mouse.empty()) viewer.paused = false;  // it is by numbers of frames that it stands still
  std::optional<Eigen::Vector2d> mouse;
  if (!run.mouse.empty()) mouse = mouseAt(run.mouse, static_cast<std::uint64_t>(picture));
  panels->draw(viewer, size, mouse);
}

}  // namespace

void runHeadless(Viewer& viewer, const ViewerFiles& files, const Viewport& size, const HeadlessRun& run,
                 std::chrono::steady_clock::time_point started) {
  prepareStart(viewer.session);
  viewer.watch.interrupted = interrupted();
  if (viewer.watch.interrupted) return;  // in the search: the blocks are as placed
  const OffscreenContext context;
  viewer.controls.viewport = size;
  const OffscreenFrame frame(size);
  Renderer renderer;
  std::unique_ptr<OffscreenPanels> panels;
  const bool hasWords = viewer.mode != Mode::bare || viewer.overlay != Overlay::wood || viewer.arrows;
  if (hasWords) panels = std::make_unique<OffscreenPanels>(viewer.choice, viewer.scale.value_or(1.0F));
  std::unique_ptr<Film> film;
  if (files.film)
    film = std::make_unique<Film>(*files.film, size, static_cast<int>(std::lround(1.0 / viewer.session.scene.settings.frame_s)));
  if (run.folder) std::filesystem::create_directories(*run.folder);
  viewer.pacer.waiting_s = 0.0;
  for (int i = 1; i <= run.frames; ++i) {
    const std::uint64_t before = viewer.session.frame;
    stepPicture(viewer, run, i);
    if (files.recorder != nullptr) files.recorder->follow(viewer.choice, viewer.session);
    // A signal that comes in the last frame interrupts nothing, unless it ended the frame's search for an equilibrium.
    viewer.watch.interrupted = interrupted() && (i < run.frames || viewer.session.frame == before);
    const bool refused = viewer.replay && !viewer.replay->refused.empty();
    const bool last = i == run.frames || viewer.watch.interrupted || refused;
    if ((i % run.every == 0 || last) && (run.folder || film)) {
      frame.bind();
      drawPicture(viewer, renderer, panels.get(), size, run, i);
      const Image image = frame.read();
      if (++viewer.watch.pictures == 1)
        viewer.watch.firstPicture_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count();
      if (run.folder) writePng(fmt::format("{}/frame-{:05}.png", *run.folder, i), "--png", image);
      if (film) film->add(image);
    }
    if (last) break;
  }
  if (film) film->finish();
}

}  // namespace springtower
