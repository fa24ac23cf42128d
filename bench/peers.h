#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <vector>

namespace springtower {

// What the programs peers_* share: other engines on our scenes, for `springtower chart`, which runs them as processes and
// measures what they do as it measures our own methods. Inside, lengths are scaled to what the engines are made for, and masses
// to 1.

/// Blocks of 1 x 0.33 x 0.22 units: Bullet's manual advises 0.05 to 10, ODE's lengths and masses "around 1".
inline constexpr double kPeerUnitsPerMetre = 1.0 / 0.081;
inline constexpr double kPeerUnitsPerKilogram = 1.0 / 0.0196;

/// A block as it starts, and later as it lies, in the engine's units and s; quaternions w, x, y, z.
struct PeerBlock {
  std::array<double, 3> centre;
  std::array<double, 4> orientation;
  std::array<double, 3> velocity;
  std::array<double, 3> spin;
  std::array<double, 3> dimensions;
  double mass;
};

/// What pushes a block through a frame, in the engine's units.
struct PeerPush {
  std::size_t block = 0;
  std::array<double, 3> force{};  ///< zero where nothing does
};

struct PeerScene {
  int substeps = 1;
  int iterations = 0;  ///< of the engine's solver; 0: its own default
  double frame_s = 0.0;
  double friction = 0.0;
  std::array<double, 3> gravity{};  ///< units/s2
  bool floor = true;
  std::vector<PeerBlock> blocks;
};

/// Reads a scene from standard input: a line with the number of blocks, substeps, iterations, frame (s), friction, gravity
/// (m/s2, three numbers) and 1 or 0 for the floor; then for each block a line with centre (m), orientation, velocity (m/s), spin
/// (rad/s), dimensions (m) and mass (kg). Throws std::runtime_error for anything else.
PeerScene readPeerScene();

/// Obeys commands of one byte from standard input until its end, and returns the exit code. `s`: one frame; writes the processor
/// time it took (s) and 13 numbers a block (centre, orientation, velocity, spin; SI) as doubles. `k`: keeps the state, in a
/// process of its own. `b`: back to the state that was kept last, which is then kept no more. `p`, and four doubles: a block and
/// the force (N) that pushes its centre in the next frame.
int servePeer(const std::function<void(const PeerPush&)>& stepFrame, const std::function<void(std::vector<PeerBlock>&)>& read,
              std::vector<PeerBlock> blocks);

}  // namespace springtower
