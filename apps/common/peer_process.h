#pragma once

#include "core/scene/scene.h"
#include "core/state.h"

#include <array>
#include <cstddef>
#include <string_view>
#include <sys/types.h>
#include <vector>

namespace springtower {

/// Another engine, which runs on our scenes where its program is (bench/peers_*.cpp).
enum class Peer { none, bullet, ode };
inline constexpr std::array<std::string_view, 3> kPeerNames = {"", "bullet", "ode"};
constexpr std::string_view nameOf(Peer peer) {
  return kPeerNames[static_cast<std::size_t>(peer)];
}

/// By which such an engine trades speed for accuracy.
struct PeerSettings {
  int substeps = 1;    ///< equal steps of a frame
  int iterations = 0;  ///< of its solver of contacts; 0: its default
};

/// The engines whose programs (bench/peers_*.cpp) are beside this one.
std::vector<Peer> peersHere();

/// Another engine at work on a scene, in a process of its own.
class PeerProcess {
 public:
  /// Starts it with a scene. Precondition: `peer` is not none. Throws InputError when the program cannot be started.
  PeerProcess(Peer peer, const PeerSettings& settings, const Scene& scene);
  PeerProcess(const PeerProcess&) = delete;
  PeerProcess& operator=(const PeerProcess&) = delete;
  ~PeerProcess();

  /// One frame: puts the blocks' corners as they now lie and move into `state`. Returns the processor time it took, s. Throws
  /// DivergenceError when the engine has ended or a block is nowhere.
  double step(MotionState& state);
  /// A force (N) on a block's centre through the next frame. Throws DivergenceError when the engine has ended.
  void push(const UserForce& force);
  /// Keeps the state as it is, and goes back to the one that was kept last, which stays kept.
  void keep();
  void restore();

 private:
  void command(char byte) const;

  std::vector<Vec3> dimensions_;
  std::vector<double> numbers_;  // of one frame
  double frame_s_;
  double time_s_ = 0.0;
  double keptTime_s_ = 0.0;
  int socket_ = -1;
  pid_t process_ = -1;
};

}  // namespace springtower
