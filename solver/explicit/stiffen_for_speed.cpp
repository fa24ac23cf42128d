#include "solver/explicit/stiffen_for_speed.h"

#include "core/elementary.h"
#include "solver/block/springs.h"
#include "solver/contact/approach.h"
#include "solver/explicit/stable_step.h"
#include "solver/world/stiffness.h"

#include <algorithm>

namespace springtower {

void stiffenForSpeed(IslandStep& step) {
  constexpr double kAhead = 2.0;  // so that what speeds up for long is made stiffer in few frames
  Simulation& simulation = step.simulation;
  double fastest = 0.0;
  for (const std::int32_t block : step.blocks)
    fastest = std::max(fastest, fastestCorner(simulation.state.velocity, static_cast<std::size_t>(block), Vec3::Zero()));
  BlockModel& model = simulation.model;
  std::vector<StepBound>& bounds = step.engine.memo.stepBound;
  bool changed = false;
  for (const std::int32_t block : step.blocks) {
    const auto b = static_cast<std::size_t>(block);
    const double length_m = simulation.lengths.blockHeight_m;
    const double needed_n_m = edgeForSpeed(model.dimensions[b], model.mass[b], elementary::square(fastest), length_m);
    if (needed_n_m <= bounds[b].edge_n_m) continue;
    bounds[b].edge_n_m = kAhead * needed_n_m;
    simulation.stiffness.edge_n_m[b] = bounds[b].edge_n_m;
    setSprings(model, b, bounds[b].edge_n_m, length_m, simulation.dampingTime_s);
    bounds[b].springRadius = blockSpectralRadius(model, simulation.scene.settings.inertia, b);
    changed = true;
  }
  if (!changed) return;
  // Islands to come may begin with any of these blocks.
  for (const std::int32_t block : step.blocks) bounds[static_cast<std::size_t>(block)].spectralRadius = 0.0;
}

}  // namespace springtower
