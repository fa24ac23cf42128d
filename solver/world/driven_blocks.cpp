#include "solver/world/driven_blocks.h"

#include <algorithm>
#include <cmath>
#include <tuple>

namespace springtower {

namespace {

double radiusOf(const Simulation& simulation, std::size_t b) {
  return 0.5 * simulation.model.dimensions[b].norm();
}

void writeCorners(const BlockSpec& spec, const DrivenPose& pose, std::size_t b, ParticleArray& position) {
  for (std::size_t c = 0; c < kCorners; ++c) {
    const Vec3 arm = 0.5 * Vec3(cornerSide(c, 0), cornerSide(c, 1), cornerSide(c, 2)).cwiseProduct(spec.dimensions);
    position.set(b, c, pose.centre + pose.turn * (spec.orientation * arm));
  }
}

void writeMotion(const DrivenPose& pose, std::size_t b, MotionState& state) {
  for (std::size_t c = 0; c < kCorners; ++c)
    state.velocity.set(b, c, pose.velocity + pose.spin.cross(state.position.at(b, c) - pose.centre));
}

// Everything that depends on the pose of one driven block.
void moveByDrives(Simulation& simulation, std::int32_t block, double before_s, double now_s, DrivenVelocity which) {
  Engine& engine = *simulation.engine;
  const auto b = static_cast<std::size_t>(block);
  const BlockSpec& spec = simulation.scene.blocks[b];
  const DrivenPose now = poseAt(simulation, block, now_s);
  MotionState& state = simulation.state;
  writeCorners(spec, now, b, state.position);
  writeMotion(now, b, state);
  const double step_s = now_s - before_s;
  engine.scratch.path[b] = 0.0;
  for (std::size_t a = 0; a < 3; ++a) std::copy_n(state.position.values(a, b), kCorners, engine.memo.previous.values(a, b));
  ParticleArray& mean = engine.scratch.drivenMean;
  for (std::size_t a = 0; a < 3; ++a) std::copy_n(state.velocity.values(a, b), kCorners, mean.values(a, b));
  if (step_s > 0.0) {
    const DrivenPose before = poseAt(simulation, block, before_s);
    writeCorners(spec, before, b, engine.memo.previous);
    engine.scratch.path[b] = now.travel_m - before.travel_m;
    for (std::size_t c = 0; c < kCorners; ++c) mean.set(b, c, (state.position.at(b, c) - engine.memo.previous.at(b, c)) / step_s);
    double most = 0.0;
    for (const Drive& drive : simulation.scene.drives) {
      if (drive.block == block) most += drive.mostSpeed_m_s(radiusOf(simulation, b));
    }
    engine.scratch.assumedPath[b] = most * step_s;
  }
  if (which == DrivenVelocity::mean) {
    for (std::size_t a = 0; a < 3; ++a) std::copy_n(mean.values(a, b), kCorners, state.velocity.values(a, b));
  }
  engine.memo.blockHistory[b].travel = now.travel_m;
  engine.memo.frames[b] = blockFrame(state.position, b);
  engine.memo.motion[b] = affineField(state.velocity, b);
  if (!engine.memo.carriedMotion.empty()) engine.memo.carriedMotion[b] = affineField(mean, b);
  if (engine.memo.carried.blockCount() > 0) {
    for (std::size_t a = 0; a < 3; ++a) std::copy_n(mean.values(a, b), kCorners, engine.memo.carried.values(a, b));
  }
}

}  // namespace

DrivenPose poseAt(const Simulation& simulation, std::int32_t block, double time_s) {
  const auto b = static_cast<std::size_t>(block);
  return drivenPose(simulation.scene.drives, block, simulation.scene.blocks[b].centre, radiusOf(simulation, b), time_s);
}

bool anyDriveActs(const Simulation& simulation, double begin_s, double end_s) {
  const std::vector<Drive>& drives = simulation.scene.drives;
  return std::any_of(drives.begin(), drives.end(), [&](const Drive& drive) { return drive.actsWithin(begin_s, end_s); });
}

std::span<const std::uint8_t> sweepDriven(Simulation& simulation) {
  Scratch& scratch = simulation.engine->scratch;
  scratch.drivenNow.clear();
  const double begin_s = simulation.time_s;
  const double end_s = begin_s + simulation.scene.settings.frame_s;
  for (const Drive& drive : simulation.scene.drives) {
    if (drive.actsWithin(begin_s, end_s)) scratch.drivenNow.push_back(drive.block);
  }
  if (scratch.drivenNow.empty()) return simulation.asleep;
  std::sort(scratch.drivenNow.begin(), scratch.drivenNow.end());
  scratch.drivenNow.erase(std::unique(scratch.drivenNow.begin(), scratch.drivenNow.end()), scratch.drivenNow.end());
  scratch.sweepAsleep.assign(simulation.asleep.begin(), simulation.asleep.end());
  SweptBoxes& boxes = simulation.engine->memo.boxes;
  for (const std::int32_t block : scratch.drivenNow) {
    const auto b = static_cast<std::size_t>(block);
    scratch.sweepAsleep[b] = 0;
    const DrivenPose begin = poseAt(simulation, block, begin_s);
    const double reach = poseAt(simulation, block, end_s).travel_m - begin.travel_m + simulation.lengths.contactError_m;
    const Eigen::Matrix3d axes = (begin.turn * simulation.scene.blocks[b].orientation).toRotationMatrix();
    const Vec3 half = axes.cwiseAbs() * (0.5 * simulation.model.dimensions[b]);
    for (std::size_t a = 0; a < 3; ++a) {
      const auto axis = static_cast<Eigen::Index>(a);
      boxes.lower[a][b] = begin.centre[axis] - half[axis] - reach;
      boxes.upper[a][b] = begin.centre[axis] + half[axis] + reach;
    }
  }
  return scratch.sweepAsleep;
}

void listNearDriven(Simulation& simulation) {
  Engine& engine = *simulation.engine;
  Scratch& scratch = engine.scratch;
  scratch.nearDriven.clear();
  if (scratch.drivenNow.empty()) return;
  std::erase_if(engine.memo.sweptPairs,
                [&](const BlockPair& pair) { return isFixed(simulation, pair.a) && isFixed(simulation, pair.b); });
  const auto isMoved = [&](std::int32_t block) {
    return std::binary_search(scratch.drivenNow.begin(), scratch.drivenNow.end(), block);
  };
  for (const BlockPair& pair : engine.memo.sweptPairs) {
    const bool first = isMoved(pair.a);
    if (!first && !isMoved(pair.b)) continue;
    const std::int32_t block = first ? pair.b : pair.a;
    scratch.nearDriven.push_back({first ? pair.a : pair.b, scratch.inParts[static_cast<std::size_t>(block)], block});
  }
  std::sort(scratch.nearDriven.begin(), scratch.nearDriven.end(), [](const NearDriven& p, const NearDriven& q) {
    return std::tie(p.driven, p.inParts, p.block) < std::tie(q.driven, q.inParts, q.block);
  });
}

void listDrivenOfIslands(Simulation& simulation) {
  Engine& engine = *simulation.engine;
  std::vector<BlockPair>& list = engine.scratch.drivenOfIslands;
  list.clear();
  for (const NearDriven& near : engine.scratch.nearDriven) {
    const std::int32_t island = engine.memo.islands.islandOf[static_cast<std::size_t>(near.block)];
    if (island >= 0) list.push_back({island, near.driven});
  }
  std::sort(list.begin(), list.end());
  const auto same = [](const BlockPair& p, const BlockPair& q) { return p.a == q.a && p.b == q.b; };
  list.erase(std::unique(list.begin(), list.end(), same), list.end());
}

void placeDriven(IslandStep& step, double before_s, double now_s, DrivenVelocity which) {
  for (const BlockPair& driven : step.driven) moveByDrives(step.simulation, driven.b, before_s, now_s, which);
}

void finishDriven(Simulation& simulation) {
  const double before_s = simulation.time_s - simulation.scene.settings.frame_s;
  for (const Drive& drive : simulation.scene.drives) {
    if (drive.actsWithin(before_s, simulation.time_s))
      moveByDrives(simulation, drive.block, simulation.time_s, simulation.time_s, DrivenVelocity::atEnd);
  }
}

}  // namespace springtower
