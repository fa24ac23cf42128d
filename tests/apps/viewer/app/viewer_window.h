#pragma once

#include "apps/viewer/input/camera.h"
#include "core/state.h"
#include "tests/apps/viewer/app/display.h"

#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

namespace springtower {

inline constexpr int kWindowWidth = 800;
inline constexpr int kWindowHeight = 600;

/// What the key I writes: what is seen, where the blocks are, and the report.
struct Inspection {
  nlohmann::json report;
  ParticleArray position;
  std::vector<std::int32_t> seen;  ///< rows from the top, -1 none

  [[nodiscard]] Vec3 centreOf(std::size_t block) const { return centre(position, block); }
  [[nodiscard]] Camera camera() const;
};

/// The program in its window, on a display in memory.
class Window {
 public:
  /// Starts it and waits for its first picture, or for its window alone. Throws std::runtime_error with its output when there is
  /// none.
  explicit Window(const std::vector<std::string>& arguments, const Viewport& size = {kWindowWidth, kWindowHeight},
                  bool waitForPicture = true);
  /// Runs a script of xdotool.
  void act(const std::string& script) { display_.act(script); }
  [[nodiscard]] bool runs() { return program_->runs(); }
  /// What it printed.
  [[nodiscard]] std::string log() const { return contentOf(scratch_.file("log")); }
  /// How long it says that its first picture took, s.
  [[nodiscard]] double firstPicture_s() const;
  /// Presses the key I and reads what it writes.
  Inspection inspect();
  /// The report that the key I writes, alone: for windows of any size.
  nlohmann::json inspectReport();
  /// Ends the program as a user does; returns its exit code.
  int close();
  /// Sends it a signal and waits for its end; returns its exit code.
  int end(int signal);
  /// Its report; written when it has ended.
  [[nodiscard]] nlohmann::json report() const { return nlohmann::json::parse(contentOf(reportFile())); }

 private:
  // Presses the key I and waits; the path of one of its files.
  void pressInspect();
  [[nodiscard]] std::string inspected(const char* name, const char* ending) const;
  [[nodiscard]] std::string reportFile() const { return scratch_.file("report.json"); }

  ScratchFolder scratch_;
  Display display_;
  std::optional<Background> program_;
  int inspections_ = 0;
};

}  // namespace springtower
