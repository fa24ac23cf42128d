// The part of window.h that needs no window.
#include "apps/common/interruption.h"
#include "apps/viewer/app/window.h"
#include "apps/viewer/io/output.h"

#include <cmath>
#include <filesystem>
#include <fmt/format.h>
#include <memory>

namespace springtower {

void runHeadless(Viewer& viewer, const ViewerFiles& files, const Viewport& size, const HeadlessRun& run,
                 std::chrono::steady_clock::time_point started) {
  const OffscreenContext context;
  viewer.controls.viewport = size;
  const OffscreenFrame frame(size);
  Renderer renderer;
  std::unique_ptr<Film> film;
  if (files.film)
    film = std::make_unique<Film>(*files.film, size, static_cast<int>(std::lround(1.0 / viewer.session.scene.settings.frame_s)));
  if (run.folder) std::filesystem::create_directories(*run.folder);
  viewer.pacer.waiting_s = 0.0;
  for (int i = 1; i <= run.frames; ++i) {
    viewer.paused = true;  // frames by number, not by time
    viewer.once = true;
    advance(viewer, 0.0);
    if (files.recorder != nullptr) files.recorder->follow(viewer.choice, viewer.session);
    viewer.watch.interrupted = i < run.frames && interrupted();
    const bool refused = viewer.replay && !viewer.replay->refused.empty();
    const bool last = i == run.frames || viewer.watch.interrupted || refused;
    if ((i % run.every == 0 || last) && (run.folder || film)) {
      frame.bind();
      renderer.draw(pictureOf(viewer), viewer.controls.camera, size);
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
