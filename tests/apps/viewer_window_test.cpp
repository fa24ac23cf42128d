// Drives the real program with a mouse and keys on a display in memory.
#include "apps/viewer_camera.h"
#include "core/random.h"
#include "core/scene.h"
#include "solver/simulation.h"
#include "tests/apps/display.h"

#include <array>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <numbers>
#include <sstream>

namespace springtower {
namespace {

using Json = nlohmann::json;

constexpr int kWidth = 800;
constexpr int kHeight = 600;
constexpr const char* kLooseTower = "(111)-(1L1)-(111)-(111)";
constexpr std::size_t kLooseBlock = 4;
constexpr double kTop_m = 4 * kBlockHeight_m;

/// What the key I writes: what is seen, where the blocks are, and the report.
struct Inspection {
  Json report;
  CornerArray position;
  std::vector<std::int32_t> seen;  // rows from the top, -1 none

  [[nodiscard]] Vec3 centreOf(std::size_t block) const { return centre(position, block); }
  [[nodiscard]] Camera camera() const {
    const Json& json = report.at("camera");
    Camera camera;
    for (int a = 0; a < 3; ++a) camera.target[a] = json.at("target_m").at(static_cast<std::size_t>(a)).get<double>();
    camera.azimuth = json.at("azimuth").get<double>();
    camera.elevation = json.at("elevation").get<double>();
    camera.distance = json.at("distance_m").get<double>();
    camera.fieldOfView = json.at("field_of_view").get<double>();
    return camera;
  }
};

CornerArray readPoses(const std::string& path) {
  std::vector<std::vector<double>> rows;
  for (const std::string& line : linesOf(contentOf(path))) {
    if (line.starts_with("time_s")) continue;
    std::istringstream stream(line);
    std::vector<double> values;
    for (std::string cell; std::getline(stream, cell, ',');) values.push_back(std::stod(cell));
    rows.push_back(values);
  }
  CornerArray position;
  position.resize(rows.size());
  for (std::size_t b = 0; b < rows.size(); ++b) {
    for (std::size_t c = 0; c < kCorners; ++c) position.set(b, c, {rows[b][2 + 3 * c], rows[b][3 + 3 * c], rows[b][4 + 3 * c]});
  }
  return position;
}

std::vector<std::int32_t> readSeen(const std::string& path) {
  const std::string content = contentOf(path);
  const std::string head = fmt::format("P5\n{} {}\n65535\n", kWidth, kHeight);
  if (!content.starts_with(head)) throw std::runtime_error("not as expected: " + path);
  std::vector<std::int32_t> seen;
  for (std::size_t i = head.size(); i + 1 < content.size(); i += 2) {
    seen.push_back(256 * static_cast<unsigned char>(content[i]) + static_cast<unsigned char>(content[i + 1]) - 1);
  }
  return seen;
}

/// The program in its window.
class Window {
 public:
  explicit Window(const std::vector<std::string>& arguments) : display_(kWidth, kHeight) {
    std::vector<std::string> all = {"--size",    fmt::format("{}x{}", kWidth, kHeight), "--out", scratch_.file("out"), "--report",
                                    reportFile()};
    all.insert(all.end(), arguments.begin(), arguments.end());
    program_.emplace("springtower-viewer", all, std::vector<std::string>{display_.variable(), "LIBGL_ALWAYS_SOFTWARE=1"},
                     scratch_.file("log"));
    const auto drawn = [&] { return contentOf(scratch_.file("log")).starts_with("first picture after"); };
    if (!waitUntil(60.0, [&] { return drawn() || !program_->runs(); }) || !drawn())
      throw std::runtime_error("no picture: " + log());
  }

  void act(const std::string& script) { display_.act(script); }
  [[nodiscard]] bool runs() { return program_->runs(); }
  [[nodiscard]] std::string log() const { return contentOf(scratch_.file("log")); }
  [[nodiscard]] std::string reportFile() const { return scratch_.file("report.json"); }
  [[nodiscard]] double firstPicture_s() const { return std::stod(log().substr(std::string("first picture after ").size())); }

  Inspection inspect() {
    ++inspections_;
    act("key i");
    const auto path = [&](const char* name, const char* ending) {
      return scratch_.file(fmt::format("out/{}-{:03}{}", name, inspections_, ending));
    };
    if (!waitUntil(60.0, [&] { return std::filesystem::exists(path("report", ".json")); })) {
      throw std::runtime_error("no inspection: " + log());
    }
    return {Json::parse(contentOf(path("report", ".json"))), readPoses(path("poses", ".csv")), readSeen(path("seen", ".pgm"))};
  }

  // Ends the program as a user does; returns its exit code.
  int close() {
    act("key Escape");
    return program_->wait(60.0);
  }
  Json report() { return Json::parse(contentOf(reportFile())); }

 private:
  ScratchFolder scratch_;
  Display display_;
  std::optional<Background> program_;
  int inspections_ = 0;
};

// The middle of a block's pixels; the block is seen there.
Eigen::Vector2i middleOf(const Inspection& inspection, std::size_t block) {
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  int count = 0;
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      if (inspection.seen[static_cast<std::size_t>(y * kWidth + x)] != static_cast<std::int32_t>(block)) continue;
      sum += Eigen::Vector2d(x, y);
      ++count;
    }
  }
  EXPECT_GT(count, 100) << "block " << block << " is not seen";
  return (sum / std::max(count, 1)).cast<int>();
}

// What the id buffer shows is what a ray through the same pixel meets, away from outlines.
void expectSeenIsPicked(const Inspection& inspection) {
  const Camera camera = inspection.camera();
  int compared = 0;
  int different = 0;
  for (int y = 2; y < kHeight; y += 7) {
    for (int x = 2; x < kWidth; x += 7) {
      const auto pick = pickBlock(inspection.position, rayThrough(camera, {kWidth, kHeight}, x + 0.5, y + 0.5));
      const std::int32_t picked = pick ? static_cast<std::int32_t>(pick->block) : -1;
      const std::int32_t seen = inspection.seen[static_cast<std::size_t>(y * kWidth + x)];
      compared += picked >= 0 || seen >= 0 ? 1 : 0;
      different += picked != seen ? 1 : 0;
    }
  }
  EXPECT_GT(compared, 200);
  EXPECT_LE(different, compared / 50);
}

// The pixels of a block reach as far to the left, to the right and up as its corners do; its lower side may be hidden.
void expectOutline(const Inspection& inspection, std::size_t block) {
  Eigen::Vector3d corners(1e9, 1e9, -1e9);  // least x, least y, largest x
  Eigen::Vector3d pixels = corners;
  const auto grow = [](Eigen::Vector3d& outline, double x, double y) {
    outline = {std::min(outline[0], x), std::min(outline[1], y), std::max(outline[2], x)};
  };
  for (std::size_t c = 0; c < kCorners; ++c) {
    const auto at = seenAt(inspection.camera(), {kWidth, kHeight}, inspection.position.at(block, c));
    grow(corners, at->x(), at->y());
  }
  for (int i = 0; i < kWidth * kHeight; ++i) {
    if (inspection.seen[static_cast<std::size_t>(i)] != static_cast<std::int32_t>(block)) continue;
    grow(pixels, i % kWidth + 0.5, i / kWidth + 0.5);
  }
  EXPECT_LT((corners - pixels).cwiseAbs().maxCoeff(), 1.0) << corners.transpose() << " and " << pixels.transpose();
}

/// A hand on the mouse that moves in small steps and looks where the block is.
class Player {
 public:
  explicit Player(Window& window) : window_(window) {}

  void moveTo(int x, int y) { window_.act(fmt::format("mousemove {} {}\n", x, y)); }
  void press(int button) { window_.act(fmt::format("mousedown {}\n", button)); }
  void release(int button) { window_.act(fmt::format("mouseup {}\n", button)); }
  // Where the mouse is does not matter for a drag, and along the view the pointer has no place at all.
  void slide(int dx, int dy) {
    std::string script;
    const int steps = std::max(std::abs(dx), std::abs(dy));
    for (int i = 1; i <= steps; ++i) {
      script += fmt::format("mousemove_relative -- {} {}\nsleep 0.005\n", dx * i / steps - dx * (i - 1) / steps,
                            dy * i / steps - dy * (i - 1) / steps);
    }
    window_.act(script);
  }
  // Slides by (0, first), and then by (0, dy) a time until the block is where it should be, as a player does who looks.
  template <class There>
  Inspection slideUntil(int first, int dy, const There& there) {
    slide(0, first);
    Inspection inspection = window_.inspect();
    for (int i = 0; i < 60 && !there(inspection); ++i) {
      slide(0, dy);
      sleepFor(0.15);
      inspection = window_.inspect();
    }
    EXPECT_TRUE(there(inspection)) << inspection.centreOf(kLooseBlock).transpose();
    return inspection;
  }

 private:
  Window& window_;
};

TEST(ViewerWindow, ShowsItsFirstPictureWithinASecond) {
  // The best of three, as another program may keep the machine busy.
  double best_s = 1e9;
  for (int i = 0; i < 3 && best_s >= 1.0; ++i) {
    Window window({});
    best_s = std::min(best_s, window.firstPicture_s());
    EXPECT_EQ(window.close(), 0) << window.log();
  }
  EXPECT_LT(best_s, 1.0);
}

TEST(ViewerWindow, APlayerDrawsTheLooseBlockAndLaysItOnTop) {
  const ScratchFolder scratch;
  const std::string recording = scratch.file("recording.jsonl");
  Window window({"--scene", kLooseTower, "--players", "1", "--no-panels", "--record", recording});
  Player player(window);
  const Inspection start = window.inspect();
  expectSeenIsPicked(start);

  // Round the tower until the loose block's end looks at the viewer, at its height.
  constexpr double kPerPixel = 0.006;
  player.moveTo(40, 300);
  player.press(1);
  player.slide(static_cast<int>(std::lround((start.camera().azimuth + 0.5 * std::numbers::pi) / kPerPixel)),
               -static_cast<int>(std::lround(start.camera().elevation / kPerPixel)));
  player.release(1);
  const Inspection faced = window.inspect();
  EXPECT_NEAR(faced.camera().azimuth, -0.5 * std::numbers::pi, 0.01);
  EXPECT_NEAR(faced.camera().elevation, 0.0, 0.01);
  expectSeenIsPicked(faced);

  // Out with the right button, up with the left, back over the tower, a quarter turn with the wheel, and down.
  const Eigen::Vector2i end = middleOf(faced, kLooseBlock);
  player.moveTo(end.x(), end.y());
  player.press(3);
  const Inspection out = player.slideUntil(240, 16, [](const Inspection& i) { return i.centreOf(kLooseBlock).y() < -0.1; });
  EXPECT_EQ(out.report.at("held_block").get<int>(), static_cast<int>(kLooseBlock));
  player.press(1);
  player.release(3);
  player.slideUntil(-200, -16, [](const Inspection& i) { return i.centreOf(kLooseBlock).z() > kTop_m + 0.02; });
  player.press(3);
  player.slideUntil(-240, -10, [](const Inspection& i) { return i.centreOf(kLooseBlock).y() > -0.006; });
  window.act("click 4\nclick 4\nclick 4\nclick 4\nclick 4\nclick 4\n");
  player.release(3);
  sleepFor(0.5);
  const double lying_m = kTop_m + 0.5 * kBlockHeight_m;
  player.slideUntil(0, 4, [&](const Inspection& i) { return i.centreOf(kLooseBlock).z() < lying_m + 0.003; });
  player.release(1);

  Inspection done;
  EXPECT_TRUE(waitUntil(30.0, [&] {
    done = window.inspect();
    return done.report.at("moves").get<int>() == 1;
  })) << done.report.dump();
  EXPECT_NEAR(done.centreOf(kLooseBlock).z(), lying_m, 1e-3);
  EXPECT_NEAR(std::abs(meanEdge(done.position, kLooseBlock, 0).normalized().x()), 1.0, 0.05);  // across the row below
  for (std::size_t b = 0; b < 12; ++b) {
    if (b == kLooseBlock) continue;
    EXPECT_LT((done.centreOf(b) - start.centreOf(b)).norm(), 5e-3) << b;
  }
  expectSeenIsPicked(done);
  expectOutline(done, kLooseBlock);

  EXPECT_EQ(window.close(), 0) << window.log();
  const Json report = window.report();
  EXPECT_LT(report.at("max_penetration_all_mm").get<double>(), 1.0);
  EXPECT_EQ(report.at("divergences").get<int>(), 0);

  // What was played can be played again, without a window, to the same states.
  const ProgramResult again =
      runProgram("springtower-viewer", {"--headless", "--replay", recording, "--report", scratch.file("again.json")});
  EXPECT_EQ(again.exitCode, 0) << again.output << again.error;
  const Json replayed = Json::parse(contentOf(scratch.file("again.json")));
  EXPECT_EQ(replayed.at("state_hash"), report.at("state_hash"));
  EXPECT_EQ(replayed.at("moves").get<int>(), 1);
}

// Camera and hover only: no block moves by a hundredth of a millimetre beyond what the tower does by itself.
TEST(ViewerWindow, LookingMovesNothing) {
  Window window({"--scene", "(111)-(111)-(111)", "--no-panels"});
  ASSERT_TRUE(waitUntil(60.0, [&] { return window.inspect().report.at("frames").get<int>() > 60; }));
  const Inspection before = window.inspect();
  RandomStream random(5, 1);
  std::string script = "keydown shift\n";
  for (int i = 0; i < 150; ++i) {
    script += fmt::format("mousemove {} {}\nsleep 0.01\n", static_cast<int>(kWidth * random.uniform()),
                          static_cast<int>(kHeight * random.uniform()));
    if (i == 50) script += "keyup shift\n";
    if (i % 20 == 0) script += i % 40 == 0 ? "click 4\n" : "click 5\n";
    if (i % 30 == 0) script += "key Left\nkey Up\n";
  }
  window.act(script);
  const Inspection after = window.inspect();
  EXPECT_NE(after.camera().azimuth, before.camera().azimuth);
  EXPECT_GT(after.report.at("frames").get<int>(), before.report.at("frames").get<int>() + 30);
  for (std::size_t b = 0; b < 9; ++b) {
    for (std::size_t c = 0; c < kCorners; ++c) {
      EXPECT_LT((after.position.at(b, c) - before.position.at(b, c)).norm(), 1e-5) << b;
    }
  }
  EXPECT_EQ(window.close(), 0) << window.log();
}

// A script of random mouse and key events.
std::string randomScript(RandomStream& random, int events) {
  constexpr std::array kKeys = {"space",
                                "n",
                                "t",
                                "o",
                                "f",
                                "q",
                                "e",
                                "w",
                                "s",
                                "a",
                                "d",
                                "Left",
                                "Right",
                                "Up",
                                "Down",
                                "equal",
                                "minus",
                                "bracketleft",
                                "bracketright",
                                "BackSpace",
                                "r"};
  const auto below = [&](double n) { return static_cast<int>(n * random.uniform()); };
  std::string script;
  for (int i = 0; i < events; ++i) {
    const double what = random.uniform();
    if (what < 0.70) {
      // Mostly over the tower, where something happens.
      script += fmt::format("mousemove {} {}\n", kWidth / 4 + below(kWidth / 2), below(kHeight));
    } else if (what < 0.90) {
      script += fmt::format("{} {}\n", random.uniform() < 0.6 ? "mousedown" : "mouseup", random.uniform() < 0.6 ? 1 : 3);
    } else if (what < 0.95) {
      script += fmt::format("click {}\n", 4 + below(2));
    } else if (what < 0.97) {
      script += fmt::format("{} shift\n", random.uniform() < 0.4 ? "keydown" : "keyup");
    } else {
      const std::string key = kKeys[static_cast<std::size_t>(below(kKeys.size()))];
      script += "key " + key + "\n";
      const bool pauses = key == "n" || key == "space" || key.starts_with("bracket");
      if (pauses) script += "sleep 0.1\nkey space\n";
    }
    script += "sleep 0.02\n";
  }
  return script;
}

void playAtRandom(Window& window, double seconds, std::uint64_t seed) {
  RandomStream random(seed, 1);
  const auto start = std::chrono::steady_clock::now();
  while (std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count() < seconds) {
    window.act(randomScript(random, 60));
    ASSERT_TRUE(window.runs()) << window.log();
  }
  window.act("keyup shift\nmouseup 1\nmouseup 3\n");
}

// SPRINGTOWER_RANDOM_SECONDS: how long, 60 unless said otherwise (the target viewer_random plays for ten minutes).
TEST(ViewerWindow, RandomInputBreaksNothing) {
  const char* given = std::getenv("SPRINGTOWER_RANDOM_SECONDS");
  const double seconds = given == nullptr ? 60.0 : std::atof(given);
  Window window({"--scene", "tower:6", "--no-panels"});
  playAtRandom(window, seconds, 1);
  const Inspection end = window.inspect();
  EXPECT_EQ(window.close(), 0) << window.log();
  const Json report = window.report();
  RecordProperty("max_penetration_mm", report.at("max_penetration_all_mm").dump());
  RecordProperty("frames", report.at("frames_stepped").dump());
  EXPECT_TRUE(report.at("finite").get<bool>());
  EXPECT_EQ(report.at("divergences").get<int>(), 0);
  EXPECT_LT(report.at("max_penetration_all_mm").get<double>(), 1.0) << report.dump(2);
  EXPECT_GT(report.at("most_move_mm").get<double>(), 1.0);  // something did happen
  EXPECT_GT(report.at("frames_stepped").get<double>(), 5.0 * seconds);
}

// Panels change the physics to anything they offer, so only the program is judged here, not what becomes of the tower.
TEST(ViewerWindow, RandomInputOnThePanelsBreaksNothing) {
  Window window({"--scene", "tower:3"});
  RandomStream random(2, 1);
  std::string script;
  for (int i = 0; i < 300; ++i) {
    script += fmt::format("mousemove {} {}\n{} 1\n", static_cast<int>(360 * random.uniform()),
                          static_cast<int>(kHeight * random.uniform()), random.uniform() < 0.7 ? "click" : "mousedown");
    if (i % 7 == 0) script += "mouseup 1\nclick 5\n";
    script += "sleep 0.02\n";
  }
  window.act(script + "mouseup 1\n");
  EXPECT_TRUE(window.runs()) << window.log();
  EXPECT_EQ(window.close(), 0) << window.log();
}

}  // namespace
}  // namespace springtower
