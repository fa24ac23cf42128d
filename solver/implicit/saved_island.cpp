#include "solver/implicit/saved_island.h"

namespace springtower {

SavedIsland::SavedIsland(const IslandStep& step) : smoothing_j_(step.smoothing_j) {
  const Engine& engine = step.engine;
  for (const std::int32_t block : step.blocks) {
    const auto b = static_cast<std::size_t>(block);
    Block& saved = blocks_.emplace_back();
    for (std::size_t c = 0; c < kCorners; ++c) saved.position[c] = step.simulation.state.position.at(b, c);
    saved.history = engine.memo.blockHistory[b];
  }
  for (const std::int32_t pair : step.pairs) {
    const auto at = static_cast<std::size_t>(pair);
    Pair& saved = pairs_.emplace_back();
    saved.phase = engine.pairs.phase[at];
    saved.clearance = engine.pairs.clearance[at];
    saved.travelAtCheck = engine.pairs.travelAtCheck[at];
    saved.axis = engine.pairs.axisOf(at);
    if (engine.pairs.touches(at)) saved.manifold = copyOf(contactOf(engine, at));
  }
}

void SavedIsland::restore(IslandStep& step) const {
  Engine& engine = step.engine;
  step.smoothing_j = smoothing_j_;
  for (std::size_t i = 0; i < blocks_.size(); ++i) {
    const auto b = static_cast<std::size_t>(step.blocks[i]);
    for (std::size_t c = 0; c < kCorners; ++c) {
      step.simulation.state.position.set(b, c, blocks_[i].position[c]);
      step.engine.memo.previous.set(b, c, blocks_[i].position[c]);
      step.simulation.state.velocity.set(b, c, Vec3::Zero());
    }
    engine.memo.blockHistory[b] = blocks_[i].history;
  }
  for (std::size_t i = 0; i < pairs_.size(); ++i) {
    const auto at = static_cast<std::size_t>(step.pairs[i]);
    engine.pairs.phase[at] = pairs_[i].phase;
    engine.pairs.clearance[at] = pairs_[i].clearance;
    engine.pairs.travelAtCheck[at] = pairs_[i].travelAtCheck;
    engine.pairs.setAxis(at, pairs_[i].axis);
    if (engine.pairs.touches(at)) engine.contacts.store(engine.pairs.contact[at], engine.pairs[at], pairs_[i].manifold);
  }
}

}  // namespace springtower
