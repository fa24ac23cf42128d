#include "bench/peers.h"

#include "core/processor_time.h"

#include <cstddef>
#include <sstream>
#include <stdexcept>
#include <string>
#include <sys/types.h>
#include <sys/wait.h>
#include <unistd.h>

namespace springtower {
namespace {

// Nothing of the input may wait in a buffer while a state is kept: the next byte belongs to whichever process reads it.
bool readByte(char& byte) {
  return ::read(STDIN_FILENO, &byte, 1) == 1;
}

std::string readLine() {
  std::string line;
  for (char c = 0; readByte(c) && c != '\n';) line += c;
  return line;
}

template <std::size_t N>
void read(std::istream& stream, std::array<double, N>& values, double scale = 1.0) {
  for (double& value : values) {
    stream >> value;
    value *= scale;
  }
}

void writeAll(const std::vector<double>& values) {
  const char* data = reinterpret_cast<const char*>(values.data());
  std::size_t left = values.size() * sizeof(double);
  while (left > 0) {
    const ssize_t written = ::write(STDOUT_FILENO, data, left);
    if (written <= 0) throw std::runtime_error("the poses cannot be written");
    data += written;
    left -= static_cast<std::size_t>(written);
  }
}

PeerPush readPush(std::size_t blocks) {
  std::array<double, 4> values{};
  char* bytes = reinterpret_cast<char*>(values.data());
  for (std::size_t i = 0; i < sizeof values; ++i) {
    if (!readByte(bytes[i])) throw std::runtime_error("standard input ends within a push");
  }
  PeerPush push;
  push.block = static_cast<std::size_t>(values[0]);
  if (push.block >= blocks)
    throw std::runtime_error("expected a push on a block of the scene, got block " + std::to_string(push.block));
  for (std::size_t k = 0; k < 3; ++k) push.force[k] = values[k + 1] * kPeerUnitsPerKilogram * kPeerUnitsPerMetre;
  return push;
}

}  // namespace

PeerScene readPeerScene() {
  PeerScene scene;
  std::size_t blocks = 0;
  std::istringstream head(readLine());
  head >> blocks >> scene.substeps >> scene.iterations >> scene.frame_s >> scene.friction;
  read(head, scene.gravity, kPeerUnitsPerMetre);
  head >> scene.floor;
  if (!head || blocks == 0 || scene.substeps < 1) throw std::runtime_error("standard input is no scene of springtower chart");
  for (std::size_t b = 0; b < blocks; ++b) {
    std::istringstream line(readLine());
    PeerBlock block{};
    read(line, block.centre, kPeerUnitsPerMetre);
    read(line, block.orientation);
    read(line, block.velocity, kPeerUnitsPerMetre);
    read(line, block.spin);
    read(line, block.dimensions, kPeerUnitsPerMetre);
    line >> block.mass;
    block.mass *= kPeerUnitsPerKilogram;
    if (!line) throw std::runtime_error("standard input: block " + std::to_string(b) + " is incomplete");
    scene.blocks.push_back(block);
  }
  return scene;
}

int servePeer(const std::function<void(const PeerPush&)>& stepFrame, const std::function<void(std::vector<PeerBlock>&)>& read,
              std::vector<PeerBlock> blocks) {
  std::vector<double> numbers;
  PeerPush push;
  for (char command = 0; readByte(command);) {
    if (command == 's') {
      const double begin_s = processorTime_s();
      stepFrame(push);
      push = PeerPush{};
      numbers.assign(1, processorTime_s() - begin_s);
      read(blocks);
      for (const PeerBlock& block : blocks) {
        for (const double value : block.centre) numbers.push_back(value / kPeerUnitsPerMetre);
        for (const double value : block.orientation) numbers.push_back(value);
        for (const double value : block.velocity) numbers.push_back(value / kPeerUnitsPerMetre);
        for (const double value : block.spin) numbers.push_back(value);
      }
      writeAll(numbers);
    } else if (command == 'p') {
      push = readPush(blocks.size());
    } else if (command == 'k') {
      const pid_t next = fork();
      if (next < 0) throw std::runtime_error("cannot keep the state: no further process");
      if (next == 0) continue;  // goes on, while the parent stays as it is
      int status = 0;
      waitpid(next, &status, 0);
      if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) return 1;
    } else if (command == 'b') {
      return 0;
    } else {
      throw std::runtime_error(std::string("expected command s, p, k or b, got '") + command + "'");
    }
  }
  return 1;
}

}  // namespace springtower
