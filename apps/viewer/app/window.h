#pragma once

#include "apps/viewer/input/mouse_script.h"
#include "apps/viewer/io/output.h"
#include "apps/viewer/view/state.h"

#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace springtower {

/// Where the viewer writes, and what it writes at the end.
struct ViewerFiles {
  std::string folder = "out";  ///< screenshots, videos, recordings
  std::optional<std::string> film;
  std::optional<std::string> record;
  std::optional<std::string> report;
  std::optional<std::string> poses;
  RecordingWriter* recorder = nullptr;  ///< follows the session from frame to frame, when it is recorded
};

/// Opens a window of this size and runs the viewer in it until the user closes it or a signal comes. `started`: when the program
/// began. Throws InputError when there is no display.
void runWindow(Viewer& viewer, const ViewerFiles& files, const Viewport& size, std::chrono::steady_clock::time_point started);

/// Steps a number of frames, or up to a signal, without a window and writes every `every`th picture and the last as
/// frame-00001.png ... into a folder. A mouse that follows a script plays as in the window, a picture each 1/60 s: `frames` are
/// then pictures.
struct HeadlessRun {
  int frames = 60;
  int every = 1;
  std::optional<std::string> folder;
  std::vector<MouseStep> mouse = {};  ///< may be empty
};
void runHeadless(Viewer& viewer, const ViewerFiles& files, const Viewport& size, const HeadlessRun& run,
                 std::chrono::steady_clock::time_point started);

}  // namespace springtower
