#include "apps/common/peer_process.h"

#include "core/block.h"
#include "core/error.h"

#include <cerrno>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fmt/format.h>
#include <iterator>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

extern char** environ;

namespace springtower {
namespace {

constexpr std::size_t kNumbersPerBlock = 13;  // centre, orientation (w, x, y, z), velocity, spin

std::string programOf(Peer peer) {
  std::error_code error;
  const std::filesystem::path own = std::filesystem::read_symlink("/proc/self/exe", error);
  return (own.parent_path() / fmt::format("peers_{}", nameOf(peer))).string();
}

// As bench/peers.h reads it.
std::string textOf(const PeerSettings& settings, const Scene& scene) {
  const Vec3 gravity = scene.gravity.at(0.0);
  std::string text = fmt::format("{} {} {} {:.17g} {:.17g} {:.17g} {:.17g} {:.17g} {}\n", scene.blocks.size(), settings.substeps,
                                 settings.iterations, scene.settings.frame_s, scene.staticFriction, gravity.x(), gravity.y(),
                                 gravity.z(), scene.floor ? 1 : 0);
  for (const BlockSpec& block : scene.blocks) {
    if (block.fixed) throw InputError(fmt::format("{}: expected no fixed block for other engines, got one", scene.name));
    const Eigen::Quaterniond& q = block.orientation;
    const Vec3 vectors[] = {block.velocity, block.spin, block.dimensions};
    text += fmt::format("{:.17g} {:.17g} {:.17g} {:.17g} {:.17g} {:.17g} {:.17g}", block.centre.x(), block.centre.y(),
                        block.centre.z(), q.w(), q.x(), q.y(), q.z());
    for (const Vec3& v : vectors) text += fmt::format(" {:.17g} {:.17g} {:.17g}", v.x(), v.y(), v.z());
    text += fmt::format(" {:.17g}\n", block.mass);
  }
  return text;
}

// Both return whether all of it went through. A process that is gone must not end this one by a signal.
bool sendAll(int socket, const char* data, std::size_t size) {
  while (size > 0) {
    const ssize_t sent = send(socket, data, size, MSG_NOSIGNAL);
    if (sent < 0 && errno == EINTR) continue;
    if (sent <= 0) return false;
    data += sent;
    size -= static_cast<std::size_t>(sent);
  }
  return true;
}

bool receiveAll(int socket, double* values, std::size_t count) {
  return recv(socket, values, count * sizeof(double), MSG_WAITALL) == static_cast<ssize_t>(count * sizeof(double));
}

void placeRigid(const double* numbers, const Vec3& dimensions, std::size_t block, MotionState& state) {
  const Vec3 middle(numbers[0], numbers[1], numbers[2]);
  const Eigen::Matrix3d axes = Eigen::Quaterniond(numbers[3], numbers[4], numbers[5], numbers[6]).normalized().toRotationMatrix();
  const Vec3 velocity(numbers[7], numbers[8], numbers[9]);
  const Vec3 spin(numbers[10], numbers[11], numbers[12]);
  for (std::size_t c = 0; c < kCorners; ++c) {
    const Vec3 sides(cornerSide(c, 0), cornerSide(c, 1), cornerSide(c, 2));
    const Vec3 arm = axes * (0.5 * sides.cwiseProduct(dimensions));
    state.position.set(block, c, middle + arm);
    state.velocity.set(block, c, velocity + spin.cross(arm));
  }
}

}  // namespace

std::vector<Peer> peersHere() {
  std::vector<Peer> here;
  for (std::size_t i = 1; i < kPeerNames.size(); ++i) {
    if (access(programOf(static_cast<Peer>(i)).c_str(), X_OK) == 0) here.push_back(static_cast<Peer>(i));
  }
  return here;
}

PeerProcess::PeerProcess(Peer peer, const PeerSettings& settings, const Scene& scene)
    : numbers_(1 + kNumbersPerBlock * scene.blocks.size()), frame_s_(scene.settings.frame_s) {
  for (const BlockSpec& block : scene.blocks) dimensions_.push_back(block.dimensions);
  const std::string text = textOf(settings, scene);  // before there is anything to end: it throws for what the engine lacks
  const std::string program = programOf(peer);
  int ends[2] = {-1, -1};
  if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0)
    throw InputError(fmt::format("expected {} to start, got: {}", program, std::strerror(errno)));
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, ends[1], STDIN_FILENO);
  posix_spawn_file_actions_adddup2(&actions, ends[1], STDOUT_FILENO);
  // In a group of its own, so that the terminal's Ctrl-C, which this program answers, does not end it in the middle of a frame.
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP);
  std::string name = program;
  char* arguments[] = {name.data(), nullptr};
  const int error = posix_spawn(&process_, program.c_str(), &actions, &attributes, arguments, environ);
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&actions);
  close(ends[1]);
  socket_ = ends[0];
  const bool sent = error == 0 && sendAll(socket_, text.data(), text.size());
  if (sent) return;
  close(socket_);
  if (error == 0) waitpid(process_, nullptr, 0);
  throw InputError(fmt::format("expected {} to start, got: {}", program, error != 0 ? std::strerror(error) : "it ended at once"));
}

PeerProcess::~PeerProcess() {
  close(socket_);  // the end of its input ends the process
  waitpid(process_, nullptr, 0);
}

void PeerProcess::command(char byte) const {
  if (!sendAll(socket_, &byte, 1)) throw DivergenceError("the engine has ended", 0, time_s_);
}

double PeerProcess::step(MotionState& state) {
  command('s');
  if (!receiveAll(socket_, numbers_.data(), numbers_.size())) throw DivergenceError("the engine has ended", 0, time_s_);
  time_s_ += frame_s_;
  for (std::size_t b = 0; b < dimensions_.size(); ++b) {
    const double* const numbers = numbers_.data() + 1 + kNumbersPerBlock * b;
    for (std::size_t i = 0; i < kNumbersPerBlock; ++i) {
      if (!std::isfinite(numbers[i])) throw DivergenceError("a block is nowhere", static_cast<int>(b), time_s_);
    }
    placeRigid(numbers, dimensions_[b], b, state);
  }
  return numbers_.front();
}

void PeerProcess::push(const UserForce& force) {
  const double numbers[] = {static_cast<double>(force.block), force.force.x(), force.force.y(), force.force.z()};
  command('p');
  if (!sendAll(socket_, reinterpret_cast<const char*>(numbers), sizeof numbers))
    throw DivergenceError("the engine has ended", 0, time_s_);
}

void PeerProcess::keep() {
  command('k');
  keptTime_s_ = time_s_;
}

void PeerProcess::restore() {
  command('b');
  command('k');
  time_s_ = keptTime_s_;
}

}  // namespace springtower
