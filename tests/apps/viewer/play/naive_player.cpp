#include "tests/apps/viewer/play/naive_player.h"

#include "core/random.h"
#include "core/rotation_vector.h"

#include <algorithm>
#include <cmath>
#include <ctime>
#include <fmt/format.h>
#include <numbers>

namespace springtower {
namespace {

constexpr int kRows = 18;
constexpr double kPi = std::numbers::pi;

double processorTime_ms() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return 1e3 * static_cast<double>(now.tv_sec) + 1e-6 * static_cast<double>(now.tv_nsec);
}

/// The mouse, the eye and the clock of the player.
class Newcomer {
 public:
  Newcomer(Viewer& viewer, NaiveGame& game) : viewer_(viewer), game_(game), random_(game.seed, 77) {}

  double between(double least, double most) { return least + (most - least) * random_.uniform(); }
  std::size_t oneOf(std::size_t count) {
    return std::min(count - 1, static_cast<std::size_t>(between(0.0, static_cast<double>(count))));
  }

  void wait(double seconds) {
    const double frame_s = viewer_.session.scene.settings.frame_s;
    for (double t = 0.0; t < seconds; t += frame_s) frame();
  }
  void moveTo(const Eigen::Vector2d& at) { pointerMoved(viewer_.controls, viewer_.session, at.x(), at.y()); }
  void press(bool pressed) { buttonChanged(viewer_.controls, viewer_.session, Button::left, pressed); }
  // Moves the mouse evenly by so many pixels, in a time.
  void slide(const Eigen::Vector2d& way, double seconds) {
    const int frames = std::max(1, static_cast<int>(seconds / viewer_.session.scene.settings.frame_s));
    const Eigen::Vector2d from(viewer_.controls.x, viewer_.controls.y);
    for (int i = 1; i <= frames; ++i) {
      moveTo(from + way * (static_cast<double>(i) / frames));
      frame();
    }
  }
  [[nodiscard]] Eigen::Vector2d seen(const Vec3& point) const {
    return *seenAt(viewer_.controls.camera, viewer_.controls.viewport, point);
  }
  [[nodiscard]] Vec3 blockAt() const { return centre(viewer_.session.simulation.state.position, game_.block); }

 private:
  void frame() {
    viewer_.session.frame_ms = 0.0;  // what a slow machine leaves out would not repeat
    const double start = processorTime_ms();
    advance(viewer_, viewer_.session.scene.settings.frame_s);
    game_.frames_ms.push_back(processorTime_ms() - start);
    game_.force_n = std::max(game_.force_n, viewer_.session.gripForce.force.norm());
  }

  Viewer& viewer_;
  NaiveGame& game_;
  RandomStream random_;
};

// The pixels where a block is seen, on a grid.
std::vector<Eigen::Vector2d> pixelsOf(const Viewer& viewer, std::size_t block) {
  constexpr int kGrid_px = 3;
  const Controls& controls = viewer.controls;
  const ParticleArray& position = viewer.session.simulation.state.position;
  Eigen::Vector2d least = Eigen::Vector2d::Constant(1e9);
  Eigen::Vector2d most = -least;
  for (std::size_t c = 0; c < kCorners; ++c) {
    const auto at = seenAt(controls.camera, controls.viewport, position.at(block, c));
    least = least.cwiseMin(*at);
    most = most.cwiseMax(*at);
  }
  std::vector<Eigen::Vector2d> pixels;
  for (double y = least.y(); y < most.y(); y += kGrid_px) {
    for (double x = least.x(); x < most.x(); x += kGrid_px) {
      const auto pick = pickBlock(position, rayThrough(controls.camera, controls.viewport, x, y));
      if (pick && index(pick->block) == block) pixels.emplace_back(x, y);
    }
  }
  return pixels;
}

// Chooses one of the blocks that the hints call loose, and where to press on it.
bool choose(const Viewer& viewer, Newcomer& player, NaiveGame& game, Eigen::Vector2d& at) {
  std::vector<std::size_t> loose;
  for (const Hint& hint : hints(viewer.session.simulation, viewer.session.contacts)) {
    if (hint.loose && mayTake(viewer.session.game, hint.block) && !pixelsOf(viewer, index(hint.block)).empty())
      loose.push_back(index(hint.block));
  }
  game.hinted = !loose.empty();
  if (!game.hinted) return false;
  game.block = loose[player.oneOf(loose.size())];
  game.row = rowOf(viewer.session.simulation, game.block);
  const std::vector<Eigen::Vector2d> pixels = pixelsOf(viewer, game.block);
  at = pixels[player.oneOf(pixels.size())];
  return true;
}

// The direction on the screen in which the block comes out towards the player, as anybody would draw it: some 20 degrees off.
Eigen::Vector2d outwards(const Viewer& viewer, Newcomer& player, std::size_t block) {
  constexpr double kAskew = 20.0 * kPi / 180.0;
  const Vec3 middle = centre(viewer.session.simulation.state.position, block);
  Vec3 along = meanEdge(viewer.session.simulation.state.position, block, 0);
  if (along.dot(cameraFrame(viewer.controls.camera).back) < 0.0) along = -along;
  const Eigen::Vector2d way = player.seen(middle + along) - player.seen(middle);
  const Eigen::Rotation2Dd askew(player.between(-kAskew, kAskew));
  return askew * way.normalized();
}

void judge(const Viewer& viewer, const ParticleArray& before, NaiveGame& game) {
  const Session& session = viewer.session;
  const ParticleArray& position = session.simulation.state.position;
  for (std::size_t b = 0; b < position.blockCount(); ++b) {
    if (b == game.block) continue;
    game.moved_mm = std::max(game.moved_mm, 1e3 * (centre(position, b) - centre(before, b)).norm());
  }
  const Vec3 middle = centre(position, game.block);
  const Vec3 along = meanEdge(position, game.block, 0).normalized();
  const Vec3 up = meanEdge(position, game.block, 2).normalized();
  // Its place is on the row that was the uppermost, as that lies: across it, side by side along y.
  const double pitch = 0.5 * (kBlockLength_m - kBlockWidth_m);
  Vec3 ground = Vec3::Zero();
  double top = 0.0;
  for (std::size_t b = position.blockCount() - 3; b < position.blockCount(); ++b) {
    ground += centre(position, b) / 3.0;
    top = std::max(top, centre(position, b).z() + 0.5 * meanEdge(position, b, 2).norm());
  }
  ground.z() = top + 0.5 * kBlockHeight_m;
  double nearest = 1e300;
  for (const double number : {-1.0, 0.0, 1.0})
    nearest = std::min(nearest, (middle - ground - number * pitch * Vec3::UnitY()).norm());
  game.off_mm = 1e3 * nearest;
  const double cosine = std::min(std::abs(along.x()), std::abs(up.z()));
  game.off_deg = std::acos(std::min(1.0, cosine)) * 180.0 / kPi;
  if (!session.failure.empty())
    game.fault = session.failure;
  else if (session.game.phase == Phase::over)
    game.fault = describe(session.game);
  else if (rowOf(session.simulation, game.block) != kRows)
    game.fault = "the block is not on the top row";
  else if (game.off_mm > 3.0)
    game.fault = fmt::format("the block lies {:.2f} mm off its place", game.off_mm);
  else if (game.off_deg > 5.0)
    game.fault = fmt::format("the block lies {:.1f} degrees askew", game.off_deg);
  else if (game.moved_mm > 0.5)
    game.fault = fmt::format("another block has moved by {:.3f} mm", game.moved_mm);
}

}  // namespace

NaiveGame playNaively(std::uint64_t seed) {
  SceneChoice choice;
  choice.players = 1;
  choice.options.heightsSigma_m = kUsualSigma_m;
  choice.options.seed = seed;
  Viewer viewer(choice, tuningOf(sceneOf(choice)));
  NaiveGame game;
  game.seed = seed;
  Newcomer player(viewer, game);
  player.wait(1.0);
  Eigen::Vector2d at;
  if (!choose(viewer, player, game, at)) return game;
  const ParticleArray before = viewer.session.simulation.state.position;
  game.frames_ms.clear();

  player.moveTo(at);
  player.press(true);
  const double drawn_s = player.between(0.8, 2.0);
  player.slide(player.between(220.0, 320.0) * outwards(viewer, player, game.block), drawn_s);
  player.wait(player.between(0.3, 1.5));
  const auto top = [&] { return player.seen({0.0, 0.0, kRows * kBlockHeight_m}); };
  player.slide({0.0, std::min(0.0, top().y() - player.seen(player.blockAt()).y()) - 40.0}, player.between(0.4, 1.0));
  player.wait(player.between(0.3, 1.5));
  Eigen::Vector2d error;
  error.y() = player.between(-15.0, 15.0);
  error.x() = player.between(-15.0, 15.0);
  player.slide(top() - player.seen(player.blockAt()) + error, player.between(0.4, 1.2));
  player.wait(player.between(0.2, 0.6));
  player.press(false);
  player.wait(4.0);
  viewer.tuning.sleep = Sleep::off;
  player.wait(5.0);
  judge(viewer, before, game);
  return game;
}

}  // namespace springtower
