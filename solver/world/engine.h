#pragma once

#include "solver/block/static_shape.h"
#include "solver/world/contact_pool.h"
#include "solver/world/frame_start.h"
#include "solver/world/memo.h"
#include "solver/world/pair_table.h"
#include "solver/world/report_state.h"
#include "solver/world/scratch.h"
#include "solver/world/simulation.h"
#include "solver/world/sleep_state.h"

#include <cstdint>
#include <vector>

namespace springtower {

/// What a running scene holds beside its model, its inputs and its motion (solver/world/simulation.h), by lifetime: the state of
/// contacts and sleep and whatever else the next frame depends on (copied into snapshots), and what may be lost between frames
/// (docs/adr/0003-ownership.md). Vectors grow only when new pairs appear, the pool of contacts when more pairs touch than before.
struct Engine {
  std::vector<double>
      springRadius;  ///< 1/s2, largest eigenvalue of M^-1 K of each block alone, in explicit methods; part of the model
  std::vector<double> roundingFactor;  ///< factor on the accepted residual of each block, at least 1; part of the model
  std::vector<StaticResponse>
      staticResponse;  ///< of blocks that may change to rigid steps, by runs of equal ones; part of the model
  std::vector<std::int32_t> responseStart;  ///< first block of each run
  PairTable pairs;
  ContactPool contacts;
  SleepState sleep;
  ReportState report;  ///< of method `report`; empty for the others
  Memo memo;
  FrameStart checkpoint;
  Scratch scratch;
};

/// Sum of the travel of both blocks of a pair, m; it grows monotonically, except on a rollback.
inline double travelOf(const Engine& engine, std::size_t pair) {
  const BlockPair& key = engine.pairs.key[pair];
  const double first = engine.memo.blockHistory[static_cast<std::size_t>(key.a)].travel;
  return key.b < 0 ? first : first + engine.memo.blockHistory[static_cast<std::size_t>(key.b)].travel;
}

/// The contact of a pair; without points where the pair is separated.
inline ContactView contactOf(const Engine& engine, std::size_t pair) {
  return engine.pairs.touches(pair) ? engine.contacts.view(engine.pairs.contact[pair], engine.pairs[pair]) : ContactView{};
}

/// The touching features of a pair. Precondition: the pair touches.
inline ManifoldShape shapeOf(const Engine& engine, std::size_t pair) {
  return shapeOf(engine.contacts.shape(engine.pairs.contact[pair]), engine.pairs[pair]);
}

/// `contact`, which is contactOf(pair), with its points at the end of an implicit step not yet accepted. Precondition: the pair
/// touches.
inline ContactView trialOf(const Engine& engine, std::size_t pair, const ContactView& contact) {
  ContactView trial = contact;
  trial.points = engine.contacts.trial(engine.pairs.contact[pair]);
  return trial;
}

/// Load of a pair's contact when the first of its blocks fell asleep; zeros where none has.
inline SleepLoad sleepLoadOf(const Engine& engine, std::size_t pair) {
  const std::int32_t contact = engine.pairs.contact[pair];
  return contact < 0 ? SleepLoad{} : engine.contacts.sleepLoad(contact);
}

/// The velocities that carried the positions during the last step: those of the state, or the mean over the stages of a
/// multi-stage method.
const ParticleArray& carriedVelocities(const Simulation& simulation);

}  // namespace springtower
