#include "solver/frame/island.h"

#include "core/tuning.h"
#include "solver/contact/query.h"
#include "solver/contact/rigid_contacts.h"
#include "solver/contact/update.h"
#include "solver/frame/explicit_steps.h"
#include "solver/frame/island_modes.h"
#include "solver/implicit/equilibrium.h"
#include "solver/implicit/run.h"
#include "solver/rigid/run.h"
#include "solver/world/checkpoint.h"

namespace springtower {

namespace {

// Puts an island back to where the part of the frame began. Needed where it was in rigid steps: its new springs have taken
// overlaps as their rest depths, which would add up over the tries. Needed also where implicit steps have given it energy.
// `failed`: they did not converge; all blocks then keep the same number of frames before the next try. Returns the time of the
// frame, s.
double takeBackImplicitSteps(IslandStep& step, bool failed) {
  std::vector<IslandHistory>& history = step.engine.memo.islandHistory;
  const std::int32_t frames = history[static_cast<std::size_t>(step.blocks.front())].rigidFrames;
  restoreIsland(step);
  if (!failed) return step.part.begin_s;
  for (const std::int32_t block : step.blocks) history[static_cast<std::size_t>(block)].rigidFrames = frames;
  return step.part.begin_s;
}

// Whether an island moves, and nothing does work on it in the frame.
bool movesAlone(const IslandStep& step, const IslandFacts& facts) {
  return facts.moves && facts.leftAlone && step.driven.empty() && step.simulation.scene.gravity.sway_deg == 0.0;
}

// Implicit steps lose energy as long as contacts last. Where a block that rocks lands or leaves in them, it may come out faster.
bool hasGained(const IslandStep& step, const IslandEnergy& before) {
  const IslandEnergy now = islandEnergy(step);
  double mass_kg = 0.0;
  for (const std::int32_t block : step.blocks) mass_kg += step.simulation.model.mass[static_cast<std::size_t>(block)];
  return now.total_j - before.total_j >
         tuning::kMaxImplicitGain * (before.kinetic_j + now.kinetic_j) + freePushOut(step.simulation, mass_kg);
}

// Implicit steps, as far as they fit and converge; then rigid ones. These also take a frame in which implicit ones gain energy.
IslandOutcome runByModes(IslandStep& step) {
  const IslandFacts facts = islandFacts(step);
  bool isStanding = false;  // found only where implicit steps fail
  IslandOutcome outcome;
  double begin_s = step.part.begin_s;
  const IslandMode mode = nextMode(begin_s > 0.0 ? ModeChange::frameContinues : ModeChange::frameBegins, facts);
  setMode(step, mode);
  if (facts.leftAlone || facts.fast) noteFallen(step);
  if (mode == IslandMode::implicit) {
    const bool isChecked = movesAlone(step, facts);
    const IslandEnergy before = isChecked ? islandEnergy(step) : IslandEnergy{};
    const std::uint64_t failures = step.counters.newtonFailures;
    outcome = runImplicitSteps(step, facts.mostlyFallen, begin_s);
    const bool ends = begin_s >= step.part.end_s;
    if (!outcome.inside || (ends && !(isChecked && hasGained(step, before)))) return outcome;
    isStanding = stands(step, facts.mostlyFallen);
    if (facts.rigidBefore || ends) {
      begin_s = takeBackImplicitSteps(step, !ends && step.counters.newtonFailures > failures);
      if (facts.leftAlone) noteFallen(step);
    }
    setMode(step, IslandMode::rigid);
  }
  const int before = outcome.substeps;
  outcome = runRigidMode(step, begin_s, isStanding);
  outcome.substeps += before;
  return outcome;
}

}  // namespace

IslandOutcome advanceIsland(IslandStep& step) {
  const Settings& settings = step.simulation.scene.settings;
  const MethodFamily family = traitsOf(settings.method).family;
  step.pointKind = pointKindOf(settings.method);
  switch (family) {
    case MethodFamily::implicit:
      return runByModes(step);
    case MethodFamily::rigid:
      return runRigidSteps(step, rigidSubsteps(settings), step.part.begin_s);
    case MethodFamily::explicitSprings:
    case MethodFamily::report:
      break;
  }
  return runExplicitSteps(step);
}

}  // namespace springtower
