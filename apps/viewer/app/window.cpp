#include "apps/viewer/app/window.h"

#include "apps/common/interruption.h"
#include "apps/common/output_file.h"
#include "apps/common/poses.h"
#include "apps/viewer/ui/panels.h"
#include "apps/viewer/ui/style.h"
#include "apps/viewer/view/fall.h"
#include "core/error.h"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <atomic>
#include <backends/imgui_impl_glfw.h>
#include <backends/imgui_impl_opengl3.h>
#include <cmath>
#include <epoxy/gl.h>
#include <filesystem>
#include <fmt/format.h>
#include <functional>
#include <future>
#include <imgui.h>
#include <system_error>

namespace springtower {
namespace {

using Clock = std::chrono::steady_clock;

constexpr double kKeyOrbit = 0.05;  // rad a key press
// While an equilibrium is searched for: how often events are polled, and after how long a message takes the picture's place.
constexpr std::chrono::milliseconds kPollInterval(50);
constexpr double kMessageAfter_s = 0.3;

double secondsSince(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

// The window and what its callbacks need.
struct Desk {
  Viewer& viewer;
  const ViewerFiles& files;
  LabDraft draft;
  GLFWwindow* window = nullptr;
  std::unique_ptr<Renderer> renderer = nullptr;
  std::unique_ptr<Film> film = nullptr;
  std::uint64_t filmedFrame = 0;
  int films = 0;
  int shots = 0;
  bool shotWanted = false;
  bool inspectionWanted = false;
  bool filmWanted = false;
  bool styleWanted = true;  // the screen's scale has changed
  // While frames are stepped or an equilibrium is searched for, which may take seconds, events are deferred.
  bool stepping = false;
  Clock::time_point steppingSince = {};
  std::vector<std::function<void()>> deferred = {};
  std::atomic<bool> closed = false;  // read by the threads that search
};

Desk& deskOf(GLFWwindow* window) {
  return *static_cast<Desk*>(glfwGetWindowUserPointer(window));
}

// At once, or after the frames that are being stepped: events read and change the session.
template <class Event>
void handle(Desk& desk, const Event& event) {
  if (!desk.stepping) return event();
  desk.deferred.emplace_back(event);
}

std::string numbered(const Desk& desk, const char* name, int number, const char* ending) {
  std::filesystem::create_directories(desk.files.folder);
  return fmt::format("{}/{}-{:03}{}", desk.files.folder, name, number, ending);
}

// A place in the window as pixels of the picture, which has more of them on a fine screen.
Eigen::Vector2d inPixels(const Desk& desk, double x, double y) {
  int width = 1;
  int height = 1;
  glfwGetWindowSize(desk.window, &width, &height);
  const Viewport& viewport = desk.viewer.controls.viewport;
  return {x * viewport.width / std::max(width, 1), y * viewport.height / std::max(height, 1)};
}

void onCursor(GLFWwindow* window, double x, double y) {
  Desk& desk = deskOf(window);
  const Eigen::Vector2d at = inPixels(desk, x, y);
  handle(desk, [&desk, at] { pointerMoved(desk.viewer.controls, desk.viewer.session, at.x(), at.y()); });
}

// A move needs more room than the screen has beside a block: while it lasts the block itself shows where the mouse is, and the
// pointer is hidden and has no bounds. It comes back where it was.
void boundPointer(Desk& desk) {
  Controls& controls = desk.viewer.controls;
  const int wanted =
      controls.hand.block != kFloor && (controls.left || controls.right) ? GLFW_CURSOR_DISABLED : GLFW_CURSOR_NORMAL;
  if (glfwGetInputMode(desk.window, GLFW_CURSOR) == wanted) return;
  glfwSetInputMode(desk.window, GLFW_CURSOR, wanted);
  double x = 0.0;
  double y = 0.0;
  glfwGetCursorPos(desk.window, &x, &y);
  const Eigen::Vector2d at = inPixels(desk, x, y);
  controls.x = at.x();  // the jump is none of the hand's
  controls.y = at.y();
}

void onButton(GLFWwindow* window, int button, int action, int) {
  Desk& desk = deskOf(window);
  const bool pressed = action == GLFW_PRESS;
  if (pressed && ImGui::GetIO().WantCaptureMouse) return;
  if (button > GLFW_MOUSE_BUTTON_MIDDLE) return;
  const Button which = button == GLFW_MOUSE_BUTTON_LEFT    ? Button::left
                       : button == GLFW_MOUSE_BUTTON_RIGHT ? Button::right
                                                           : Button::middle;
  handle(desk, [&desk, which, pressed] {
    buttonChanged(desk.viewer.controls, desk.viewer.session, which, pressed);
    boundPointer(desk);
  });
}

void onScroll(GLFWwindow* window, double, double steps) {
  Desk& desk = deskOf(window);
  if (!ImGui::GetIO().WantCaptureMouse) handle(desk, [&desk, steps] { wheelTurned(desk.viewer.controls, steps); });
}

// Keys that may be held down.
void onRepeatedKey(Viewer& viewer, int key) {
  Controls& controls = viewer.controls;
  switch (key) {
    case GLFW_KEY_Q:
      return turnHand(controls, TurnAxis::vertical, kKeyTurn);
    case GLFW_KEY_E:
      return turnHand(controls, TurnAxis::vertical, -kKeyTurn);
    case GLFW_KEY_W:
      return turnHand(controls, TurnAxis::right, -kKeyTurn);
    case GLFW_KEY_S:
      return turnHand(controls, TurnAxis::right, kKeyTurn);
    case GLFW_KEY_A:
      return turnHand(controls, TurnAxis::view, kKeyTurn);
    case GLFW_KEY_D:
      return turnHand(controls, TurnAxis::view, -kKeyTurn);
    case GLFW_KEY_LEFT:
      return lookRound(controls, -kKeyOrbit, 0.0);
    case GLFW_KEY_RIGHT:
      return lookRound(controls, kKeyOrbit, 0.0);
    case GLFW_KEY_UP:
      return lookRound(controls, 0.0, kKeyOrbit);
    case GLFW_KEY_DOWN:
      return lookRound(controls, 0.0, -kKeyOrbit);
    case GLFW_KEY_EQUAL:
      return comeNearer(controls, 1.0);
    case GLFW_KEY_MINUS:
      return comeNearer(controls, -1.0);
    case GLFW_KEY_N:
      viewer.paused = viewer.once = true;
      return;
    case GLFW_KEY_LEFT_BRACKET:
      return travel(viewer, viewer.session.frame == 0 ? 0 : viewer.session.frame - 1);
    case GLFW_KEY_RIGHT_BRACKET:
      return travel(viewer, viewer.session.frame + 1);
    default:
      return;
  }
}

void onPressedKey(Desk& desk, int key) {
  Viewer& viewer = desk.viewer;
  switch (key) {
    case GLFW_KEY_SPACE:
      if (viewer.fall.stage != FallStage::none) return skipFall(viewer);
      viewer.paused = !viewer.paused && viewer.session.failure.empty();
      return;
    case GLFW_KEY_R:
      return again(viewer);
    case GLFW_KEY_T:
      viewer.pacer.rate = nextRate(viewer.pacer.rate);
      return;
    case GLFW_KEY_BACKSPACE:
      return undo(viewer);
    case GLFW_KEY_O:
      viewer.overlay = static_cast<Overlay>((static_cast<std::size_t>(viewer.overlay) + 1) % kOverlays);
      return;
    case GLFW_KEY_F:
      viewer.arrows = !viewer.arrows;
      return;
    case GLFW_KEY_TAB:
      return setMode(viewer, viewer.mode == Mode::lab ? Mode::play : Mode::lab);
    case GLFW_KEY_P:
      desk.shotWanted = true;
      return;
    case GLFW_KEY_I:
      desk.inspectionWanted = true;
      return;
    case GLFW_KEY_V:
      desk.filmWanted = true;
      return;
    default:
      return;
  }
}

void onKey(GLFWwindow* window, int key, int, int action, int) {
  Desk& desk = deskOf(window);
  const bool typed = ImGui::GetIO().WantTextInput;
  if (key == GLFW_KEY_ESCAPE && action == GLFW_PRESS && !typed) return glfwSetWindowShouldClose(window, GLFW_TRUE);
  handle(desk, [&desk, key, action, typed] {
    const bool isShift = key == GLFW_KEY_LEFT_SHIFT || key == GLFW_KEY_RIGHT_SHIFT;
    if (isShift && action != GLFW_REPEAT) freeKeyChanged(desk.viewer.controls, desk.viewer.session, action == GLFW_PRESS);
    if (action == GLFW_RELEASE || typed) return;
    if (action == GLFW_PRESS) onPressedKey(desk, key);
    onRepeatedKey(desk.viewer, key);
  });
}

void writeShot(Desk& desk, const Image& image) {
  const std::string path = numbered(desk, "shot", ++desk.shots, ".png");
  writePng(path, "screenshot", image);
  desk.viewer.message = "written: " + path;
}

// What is seen, as numbers: for tests, and for a look at a tower elsewhere. The report comes last: when it is there, all is.
void writeInspection(Desk& desk, const Picture& picture) {
  Viewer& viewer = desk.viewer;
  const Viewport& viewport = viewer.controls.viewport;
  const double frame_s = viewer.session.scene.settings.frame_s;
  const int number = ++desk.shots;
  writeBlocksSeen(numbered(desk, "seen", number, ".pgm"), "inspection",
                  desk.renderer->blocksSeen(picture, viewer.controls.camera, viewport), viewport);
  OutputFile poses(numbered(desk, "poses", number, ".csv"), "inspection");
  PoseWriter(poses.stream(), frame_s, frame_s).frame(viewer.session.simulation);
  poses.commit();
  OutputFile report(numbered(desk, "report", number, ".json"), "inspection");
  writeViewerReport(report.stream(), viewer);
  report.commit();
}

void saveRecording(Desk& desk) {
  const Session& session = desk.viewer.session;
  if (session.forgotten > 0) {
    throw InputError(fmt::format("recording: its first {:.0f} minutes are forgotten; --record FILE writes a whole game",
                                 static_cast<double>(session.forgotten) * session.scene.settings.frame_s / 60.0));
  }
  const std::string path = numbered(desk, "recording", ++desk.shots, ".jsonl");
  OutputFile file(path, "recording");
  const auto end = session.log.begin() + static_cast<std::ptrdiff_t>(std::min<std::size_t>(session.frame, session.log.size()));
  writeRecording(file.stream(), {desk.viewer.choice, {session.log.begin(), end}, {}});
  file.commit();
  desk.viewer.message = "written: " + path;
}

void toggleFilm(Desk& desk) {
  if (desk.film) {
    desk.film->finish();
    desk.film.reset();
    desk.viewer.message = "the video is written";
    return;
  }
  const std::string path = desk.files.film && desk.films == 0 ? *desk.files.film : numbered(desk, "film", desk.films + 1, ".mp4");
  desk.film = std::make_unique<Film>(path, desk.viewer.controls.viewport,
                                     static_cast<int>(std::lround(1.0 / desk.viewer.session.scene.settings.frame_s)));
  ++desk.films;
  desk.viewer.message = "recording video: " + path;
}

// Files that cannot be written are reported, not fatal: the game goes on.
template <class Action>
void tell(Desk& desk, const Action& action) {
  try {
    action();
  } catch (const InputError& error) {
    desk.viewer.message = error.what();
  } catch (const std::filesystem::filesystem_error& error) {
    desk.viewer.message = error.what();
  }
}

void writePicture(Desk& desk, const Picture& picture, const PanelWishes& wishes) {
  const Viewport& viewport = desk.viewer.controls.viewport;
  if (desk.shotWanted || wishes.screenshot) tell(desk, [&] { writeShot(desk, Renderer::read(viewport)); });
  if (desk.inspectionWanted) tell(desk, [&] { writeInspection(desk, picture); });
  if (desk.filmWanted || wishes.film) tell(desk, [&] { toggleFilm(desk); });
  if (wishes.recording) tell(desk, [&] { saveRecording(desk); });
  desk.shotWanted = desk.inspectionWanted = desk.filmWanted = false;
  if (!desk.film || desk.filmedFrame == desk.viewer.session.frame) return;
  desk.filmedFrame = desk.viewer.session.frame;
  desk.film->add(Renderer::read(viewport));
}

// Fonts and sizes for the screen that the window is on. In a window whose units are larger than pixels, the units grow with them.
void updateStyle(Desk& desk) {
  if (!std::exchange(desk.styleWanted, false)) return;
  float content = 1.0F;
  glfwGetWindowContentScale(desk.window, &content, nullptr);
  content = desk.viewer.scale.value_or(content);
  int units = 1;
  int pixels = 1;
  glfwGetWindowSize(desk.window, &units, nullptr);
  glfwGetFramebufferSize(desk.window, &pixels, nullptr);
  useStyle(content, units > 0 && pixels > 0 ? static_cast<float>(pixels) / static_cast<float>(units) : 1.0F);
  ImGui_ImplOpenGL3_DestroyFontsTexture();  // it is made anew with the next frame
}

void drawWindow(Desk& desk) {
  const Clock::time_point start = Clock::now();
  Viewer& viewer = desk.viewer;
  Viewport& viewport = viewer.controls.viewport;
  glfwGetFramebufferSize(desk.window, &viewport.width, &viewport.height);
  viewport = {std::max(viewport.width, 1), std::max(viewport.height, 1)};
  if (viewer.watch.pictures > 0) followStatics(viewer, false);  // the first picture has the processors for itself
  const Picture picture = pictureOf(viewer);
  desk.renderer->draw(picture, viewer.controls.camera, viewport);
  updateStyle(desk);
  ImGui_ImplOpenGL3_NewFrame();
  ImGui_ImplGlfw_NewFrame();
  ImGui::NewFrame();
  const PanelWishes wishes = drawPanels(viewer, desk.draft, desk.film != nullptr);
  ImGui::Render();
  ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
  writePicture(desk, picture, wishes);
  viewer.picture_ms = static_cast<float>(1e3 * secondsSince(start));
  glfwSwapBuffers(desk.window);
}

// In place of the picture, whose blocks are being moved.
void drawSearching(Desk& desk, double passed_s) {
  int width = 1;
  int height = 1;
  glfwGetFramebufferSize(desk.window, &width, &height);
  glViewport(0, 0, width, height);
  glClearColor(0.16F, 0.16F, 0.17F, 1.0F);
  glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
  updateStyle(desk);
  ImGui_ImplOpenGL3_NewFrame();
  ImGui_ImplGlfw_NewFrame();
  ImGui::NewFrame();
  const std::string words =
      fmt::format("looking for the equilibrium of {} blocks: {:.0f} s\nEscape closes", desk.viewer.start.blockCount(), passed_s);
  const ImVec2 window = ImGui::GetIO().DisplaySize;
  const ImVec2 size = ImGui::CalcTextSize(words.c_str());
  ImGui::GetBackgroundDrawList()->AddText({0.5F * (window.x - size.x), 0.5F * (window.y - size.y)},
                                          ImGui::GetColorU32(ImGuiCol_Text), words.c_str());
  ImGui::Render();
  ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
  glfwSwapBuffers(desk.window);
}

void beginStepping(Desk& desk) {
  desk.stepping = true;
  desk.steppingSince = Clock::now();
}

void endStepping(Desk& desk) {
  desk.stepping = false;
  for (const auto& event : std::exchange(desk.deferred, {})) event();
}

// While an equilibrium is searched for on other threads: so that the window can be closed, and shows what is being done. GLFW and
// OpenGL are used by the window's own thread alone.
void pollUntilDone(Desk& desk, std::future<void>& search) {
  try {
    while (search.wait_for(kPollInterval) != std::future_status::ready) {
      glfwPollEvents();
      if (glfwWindowShouldClose(desk.window) == GLFW_TRUE) desk.closed = true;
      const double passed_s = secondsSince(desk.steppingSince);
      if (passed_s > kMessageAfter_s) drawSearching(desk, passed_s);
    }
  } catch (...) {
    desk.closed = true;  // ends the search, for which the future waits
    throw;
  }
  search.get();
}

void waitForStart(Desk& desk, std::future<void>& prepared) {
  beginStepping(desk);
  pollUntilDone(desk, prepared);
  endStepping(desk);
}

// A search in the middle of a game. One that a key or a panel begins runs inside a callback or a frame of Dear ImGui, from which
// GLFW does not allow polling; nor is there any where the system has no more threads.
void runSearch(Desk& desk, const std::function<void()>& search) {
  std::future<void> done;
  try {
    if (desk.stepping) done = std::async(std::launch::async, search);
  } catch (const std::system_error&) {
  }
  if (!done.valid()) return search();
  pollUntilDone(desk, done);
}

void stepFrames(Desk& desk, double elapsed_s) {
  beginStepping(desk);
  advance(desk.viewer, elapsed_s);
  endStepping(desk);
}

// GLFW and its window stay until the program ends, which gives all back: what a driver keeps in its own variables would count as
// lost memory once the driver is unloaded, and hide what we lose.
void startGlfw() {
  if (glfwInit() == GLFW_TRUE) return;
  const char* why = nullptr;
  glfwGetError(&why);
  throw InputError(fmt::format("display: expected one that opens a window, got none: {}; without a display use --headless",
                               why == nullptr ? "unknown" : why));
}

struct ImGuiUse {
  explicit ImGuiUse(GLFWwindow* window) {
    ImGui::CreateContext();
    ImGui::GetIO().IniFilename = nullptr;
    ImGui_ImplGlfw_InitForOpenGL(window, true);
    ImGui_ImplOpenGL3_Init("#version 330 core");
  }
  ImGuiUse(const ImGuiUse&) = delete;
  ImGuiUse& operator=(const ImGuiUse&) = delete;
  ~ImGuiUse() {
    ImGui_ImplOpenGL3_Shutdown();
    ImGui_ImplGlfw_Shutdown();
    ImGui::DestroyContext();
  }
};

// What a session calls in a search refers to the window's data, and must not outlive them.
struct SearchUse {
  explicit SearchUse(Desk& desk) : session(desk.viewer.session) {
    session.searchGoesOn = [&desk] { return !desk.closed; };
    session.runSearch = [&desk](const std::function<void()>& search) { runSearch(desk, search); };
  }
  SearchUse(const SearchUse&) = delete;
  SearchUse& operator=(const SearchUse&) = delete;
  ~SearchUse() {
    session.searchGoesOn = {};
    session.runSearch = {};
  }
  Session& session;
};

// A hidden window whose context is current; null where there is none with so many samples a pixel.
GLFWwindow* hiddenWindow(const Viewport& size, int samples) {
  glfwWindowHint(GLFW_SAMPLES, samples);
  GLFWwindow* window = glfwCreateWindow(size.width, size.height, "springtower-viewer", nullptr, nullptr);
  if (window != nullptr) glfwMakeContextCurrent(window);
  return window;
}

// A window whose context is current, with four samples a pixel unless the processor has to draw them. Whether it has to is known
// once there is a window: the plain one comes first, as a second one takes a tenth of a second where the processor draws.
GLFWwindow* openedWindow(const Viewport& size) {
  glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 3);
  glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 3);
  glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
  glfwWindowHint(GLFW_VISIBLE, GLFW_FALSE);
  GLFWwindow* window = hiddenWindow(size, 0);
  if (window != nullptr && !drawsInSoftware()) {
    if (GLFWwindow* smooth = hiddenWindow(size, 4); smooth != nullptr) {
      glfwDestroyWindow(window);
      window = smooth;
    }
  }
  if (window != nullptr) {
    glfwShowWindow(window);
    return window;
  }
  const char* why = nullptr;
  glfwGetError(&why);
  throw InputError(fmt::format("display: expected OpenGL 3.3, got none: {}; without it use springtower run",
                               why == nullptr ? "unknown" : why));
}

}  // namespace

void runWindow(Viewer& viewer, const ViewerFiles& files, const Viewport& size, Clock::time_point started) {
  Desk desk{viewer, files, LabDraft(viewer.choice)};
  const SearchUse search(desk);
  // The window opens meanwhile.
  std::future<void> prepared = std::async(std::launch::async, [&] { prepareStart(viewer.session); });
  startGlfw();
  desk.window = openedWindow(size);
  glfwSwapInterval(1);
  glfwSetWindowUserPointer(desk.window, &desk);
  glfwSetCursorPosCallback(desk.window, onCursor);
  glfwSetMouseButtonCallback(desk.window, onButton);
  glfwSetScrollCallback(desk.window, onScroll);
  glfwSetKeyCallback(desk.window, onKey);
  glfwSetWindowContentScaleCallback(desk.window, [](GLFWwindow* window, float, float) { deskOf(window).styleWanted = true; });
  const ImGuiUse imgui(desk.window);
  desk.renderer = std::make_unique<Renderer>();
  if (files.film) tell(desk, [&] { toggleFilm(desk); });

  waitForStart(desk, prepared);
  Clock::time_point last = Clock::now();
  Clock::time_point shown = last;
  while (glfwWindowShouldClose(desk.window) == GLFW_FALSE && !interrupted()) {
    glfwPollEvents();
    boundPointer(desk);
    stepFrames(desk, std::chrono::duration<double>(Clock::now() - std::exchange(last, Clock::now())).count());
    if (viewer.watch.firstFrame_s == 0.0 && viewer.session.frame > 0) viewer.watch.firstFrame_s = secondsSince(shown);
    if (files.recorder != nullptr) tell(desk, [&] { files.recorder->follow(viewer.choice, viewer.session); });
    drawWindow(desk);
    if (++viewer.watch.pictures > 1) continue;
    shown = Clock::now();
    // The clock starts with the picture: one frame is due now.
    last =
        shown - std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(viewer.session.scene.settings.frame_s));
    viewer.watch.firstPicture_s = secondsSince(started);
    fmt::print("first picture after {:.3f} s\n", viewer.watch.firstPicture_s);
    std::fflush(stdout);
  }
  viewer.watch.interrupted = interrupted();
  if (desk.film && viewer.watch.pictures > 0) desk.film->finish();
  desk.renderer.reset();
}

}  // namespace springtower
