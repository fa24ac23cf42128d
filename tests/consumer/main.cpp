// A program outside the repository: it finds the installed library, lets a small tower stand for a second and looks at it.
#include "core/scene/scene.h"
#include "core/version.h"
#include "solver/world/simulation.h"

#include <cstdio>

int main() {
  const int rows = 3;
  const springtower::Scene scene = springtower::towerScene(rows);
  springtower::Simulation simulation(scene);
  for (int frame = 0; frame < 60; ++frame) springtower::stepFrame(simulation);

  const std::size_t top = scene.blocks.size() - 1;
  const double fall_m = scene.blocks[top].centre.z() - springtower::centre(simulation.state.position, top).z();
  std::printf("springtower %s: the top block sank by %.4f mm\n", springtower::kVersion.data(), 1e3 * fall_m);
  // Each row may be compressed, and sink into what carries it, by the tolerance.
  return fall_m > 0.0 && fall_m <= 2 * rows * simulation.tolerance_m ? 0 : 1;
}
