#include "tests/fuzz/fuzz.h"

#include "core/error.h"
#include "solver/frame/prepare.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fmt/format.h>
#include <stdexcept>
#include <sys/mman.h>
#include <unistd.h>

namespace springtower {
namespace {

bool allFinite(const ParticleArray& array) {
  for (const auto& values : array.component) {
    if (!std::all_of(values.begin(), values.end(), [](double value) { return std::isfinite(value); })) return false;
  }
  return true;
}

void requireForces(const Simulation& simulation) {
  const Energy now = energy(simulation);
  requireThat(std::isfinite(now.total()), "the energy is finite");
  for (const ContactForce& contact : contactForces(simulation)) {
    requireThat(contact.point.allFinite() && contact.frictionForce.allFinite() && contact.normal.allFinite(),
                "contact forces are finite");
    requireThat(std::isfinite(contact.normalForce) && contact.normalForce >= 0.0, "a contact pushes");
  }
}

}  // namespace

void requireThat(bool holds, std::string_view what) {
  if (holds) return;
  std::fputs(fmt::format("does not hold: {}\n", what).c_str(), stderr);
  std::abort();
}

void requireMessage(std::string_view message, std::string_view file) {
  const bool oneLine =
      std::none_of(message.begin(), message.end(), [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7f; });
  requireThat(!message.empty() && oneLine, fmt::format("'{}' is a message of one line", message));
  requireThat(message.find(file) != std::string_view::npos, fmt::format("'{}' names the file", message));
}

void stepFrames(const Scene& scene, int frames) {
  if (scene.blocks.size() > kMostBlocks) return;
  try {
    Simulation simulation(scene);
    if (simulation.fixedSubsteps > kMostSubsteps) return;
    prepare(simulation);
    for (int i = 0; i < frames; ++i) {
      stepFrame(simulation);
      requireFinite(simulation);
      requireForces(simulation);
      if (simulation.substeps > kMostSubsteps) return;
    }
  } catch (const InputError& error) {
    requireMessage(error.what());
  } catch (const DivergenceError& error) {
    requireMessage(error.what());
  }
}

void requireFinite(const Simulation& simulation) {
  requireThat(allFinite(simulation.state.position) && allFinite(simulation.state.velocity),
              "positions and velocities are finite");
}

InputFile::InputFile(std::string_view content) : file_(memfd_create("fuzz", MFD_CLOEXEC)) {
  if (file_ < 0) throw std::runtime_error("no memory for a file");
  path_ = fmt::format("/proc/self/fd/{}", file_);
  while (!content.empty()) {
    const ssize_t count = write(file_, content.data(), content.size());
    if (count <= 0) throw std::runtime_error("no memory for a file");
    content.remove_prefix(static_cast<std::size_t>(count));
  }
}

InputFile::~InputFile() {
  close(file_);
}

}  // namespace springtower
