#pragma once

#include "solver/hand/grip.h"
#include "solver/world/simulation.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <springtower/world.h>
#include <vector>

namespace springtower::api {

/// How a world leads its hand from frame to frame.
struct HandLead {
  Draw draw;           ///< the hand and its grip; its block is the engine's kFloor where it holds none
  bool pulls = false;  ///< draws its block along a line, else leads it to `target`
  springtower::Vec3 target = Eigen::Vector3d::Zero();  ///< m, where the block's centre is to be
  double speed_m_s = 0.0;                              ///< at which the hand goes there
};

/// That a frame threw, at a time that is still to be given.
inline Divergence unfinishedFrame() {
  return {kFloor, 0.0, "a frame could not be finished"};
}

/// What a world is made of.
struct WorldImpl {
  explicit WorldImpl(const springtower::Scene& scene) : simulation(scene) {}

  springtower::Simulation simulation;
  HandLead lead;
  std::vector<springtower::UserForce> passing;  ///< forces through the coming frame alone
  std::uint64_t sceneHash = 0;                  ///< of all that decides how the scene runs, as it was given
  std::optional<Divergence> divergence;
  Divergence unfinished = unfinishedFrame();  ///< what a frame fails with that throws, made before: memory may be out by then
};

/// What a snapshot is made of.
struct SnapshotData {
  std::shared_ptr<const springtower::Snapshot> simulation;
  HandLead lead;
  std::vector<springtower::UserForce> passing;
  std::uint64_t sceneHash = 0;
  double time_s = 0.0;
};

/// Lets the functions of inputs.h and query.h at a world's inside.
struct WorldAccess {
  /// Throws InputError for a world that has been moved from.
  static WorldImpl& impl(World& world);
  static const WorldImpl& impl(const World& world);
  /// Throws InputError for a world that has failed, too.
  static WorldImpl& running(World& world);
  static const WorldImpl& running(const World& world);
};

/// Lets the hand hold its block in the coming frame, a little farther on its way; releases where it has none.
void leadHand(WorldImpl& impl);

/// A block's position in the engine's arrays. Throws InputError naming `what` unless it is 0 to `count` less one.
std::size_t checkedBlock(int block, std::size_t count, const char* what = "block");

}  // namespace springtower::api
