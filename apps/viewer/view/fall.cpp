#include "apps/viewer/view/fall.h"

#include "apps/viewer/input/view.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace springtower {
namespace {

constexpr double kRewind_s = 0.6;   // how long going back takes
constexpr double kElevation = 0.2;  // rad, of the camera at a fall
constexpr double kNear_m = 0.45;    // how far from the tower's middle a block may lie to be shown
constexpr double kNoWay_m = 0.01;   // less than that of all moves together is no way

std::uint64_t framesOf(const Viewer& viewer, double seconds) {
  return static_cast<std::uint64_t>(std::lround(seconds / viewer.session.scene.settings.frame_s));
}

// The oldest pose that is shown, and the last one.
double firstPose(const Viewer& viewer) {
  const auto shown = framesOf(viewer, kFallBefore_s + kFallAfter_s);
  const std::uint64_t left = viewer.fall.end - std::min(viewer.fall.end, viewer.session.frame);
  const auto count = viewer.poses.count();
  return static_cast<double>(count - std::min<std::size_t>(count, shown - std::min(shown, left)));
}

double lastPose(const Viewer& viewer) {
  return static_cast<double>(viewer.poses.count()) - 1.0;
}

void start(Viewer& viewer) {
  letGo(viewer.controls);
  viewer.controls.home.reset();
  viewer.controls.looked = false;
  viewer.fall.stage = FallStage::rewinding;
  viewer.fall.at = lastPose(viewer);
  viewer.fall.goal = bestSide(viewer.controls.camera, viewer.poses.at(static_cast<std::size_t>(firstPose(viewer))),
                              viewer.poses.at(viewer.poses.count() - 1));
  viewer.paused = false;
  viewer.pacer.rate = 1.0;
}

void stop(Viewer& viewer) {
  viewer.fall.stage = FallStage::stopped;
  viewer.pacer.rate = 1.0;
  viewer.paused = true;
}

void turnCamera(Viewer& viewer, double elapsed_s) {
  if (viewer.controls.looked) viewer.fall.goal.reset();
  if (viewer.fall.goal) ease(viewer.controls.camera, *viewer.fall.goal, elapsed_s);
}

}  // namespace

bool followFall(Viewer& viewer, double elapsed_s) {
  FallReplay& fall = viewer.fall;
  const Session& session = viewer.session;
  const double frames = elapsed_s / session.scene.settings.frame_s;
  if (fall.stage == FallStage::none) {
    const bool lost = session.game.phase == Phase::over && viewer.mode == Mode::play && !viewer.replay;
    if (!lost || viewer.poses.count() == 0) return false;
    fall.cause = causeOf(session.game);
    fall.end = session.frame + framesOf(viewer, kFallAfter_s);
    start(viewer);
  }
  turnCamera(viewer, elapsed_s);
  switch (fall.stage) {
    case FallStage::rewinding:
      fall.at -= frames * kFallBefore_s / kRewind_s;
      if (fall.at <= firstPose(viewer)) fall.stage = FallStage::passing;
      fall.at = std::max(fall.at, firstPose(viewer));
      return true;
    case FallStage::passing:
      fall.at += kFallRate * frames;
      if (fall.at < lastPose(viewer)) return true;
      fall.stage = FallStage::following;
      viewer.pacer.rate = kFallRate;
      viewer.pacer.waiting_s = 0.0;
      [[fallthrough]];
    case FallStage::following:
      if (session.frame >= fall.end || !session.failure.empty()) stop(viewer);
      return false;
    default:
      return false;
  }
}

void watchFall(Viewer& viewer) {
  if (viewer.fall.stage != FallStage::none && viewer.poses.count() > 0) start(viewer);
}

void skipFall(Viewer& viewer) {
  if (viewer.fall.stage != FallStage::none) stop(viewer);
}

void endFall(Viewer& viewer) {
  if (viewer.fall.stage != FallStage::none) {
    viewer.paused = false;
    viewer.pacer.rate = 1.0;
  }
  viewer.fall = {};
  viewer.poses.clear();
}

bool showsPast(const FallReplay& fall) {
  return fall.stage == FallStage::rewinding || fall.stage == FallStage::passing;
}

void pastPoses(const Viewer& viewer, ParticleArray& position) {
  const double last = lastPose(viewer);
  const double at = std::clamp(viewer.fall.at, 0.0, last);
  const auto below = static_cast<std::size_t>(at);
  const ParticleArray& before = viewer.poses.at(below);
  const ParticleArray& after = viewer.poses.at(std::min(below + 1, viewer.poses.count() - 1));
  const double share = at - static_cast<double>(below);
  position.resize(before.blockCount());
  for (std::size_t a = 0; a < 3; ++a) {
    for (std::size_t i = 0; i < before.component[a].size(); ++i) {
      const double from = before.component[a][i];
      position.component[a][i] = from + share * (after.component[a][i] - from);
    }
  }
}

Camera bestSide(const Camera& camera, const ParticleArray& before, const ParticleArray& after) {
  const std::size_t blocks = before.blockCount();
  Vec3 middle = Vec3::Zero();
  for (std::size_t b = 0; b < blocks; ++b) middle += centre(before, b) / static_cast<double>(blocks);
  Eigen::Matrix2d moves = Eigen::Matrix2d::Zero();
  ParticleArray shown;
  shown.resize(2 * blocks);
  for (std::size_t b = 0; b < blocks; ++b) {
    const Vec3 move = centre(after, b) - centre(before, b);
    const bool near = (centre(after, b) - middle).head<2>().norm() < kNear_m;
    if (near) moves += move.head<2>() * move.head<2>().transpose();
    for (std::size_t c = 0; c < kCorners; ++c) {
      shown.set(2 * b, c, before.at(b, c));
      shown.set(2 * b + 1, c, near ? after.at(b, c) : before.at(b, c));
    }
  }
  Camera best = camera;
  showAll(best, shown);
  best.elevation = kElevation;
  if (moves.trace() < kNoWay_m * kNoWay_m) return best;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> axes(moves);  // ascending
  const Eigen::Vector2d way = axes.eigenvectors().col(1);
  best.azimuth = squareTo(camera, Vec3(way.x(), way.y(), 0.0));
  return best;
}

}  // namespace springtower
