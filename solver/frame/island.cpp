#include "solver/frame/island.h"

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

// Puts an island that was in rigid steps back to where they left it: the springs that it got for implicit steps have taken its
// overlaps as their rest depths, which would add up over the tries. Returns the time of the frame, s.
double takeBackImplicitSteps(IslandStep& step) {
  std::vector<IslandHistory>& history = step.engine.memo.islandHistory;
  const std::int32_t frames = history[static_cast<std::size_t>(step.blocks.front())].explicitFrames;
  restoreIsland(step);
  for (const std::int32_t block : step.blocks) history[static_cast<std::size_t>(block)].explicitFrames = frames;
  return step.part.begin_s;
}

// Implicit steps, as far as they fit and converge; then rigid or explicit ones, as the table of island_modes.h has it.
IslandOutcome runByModes(IslandStep& step) {
  IslandFacts facts = islandFacts(step);
  IslandOutcome outcome;
  double begin_s = step.part.begin_s;
  IslandMode mode = nextMode(begin_s > 0.0 ? ModeChange::frameContinues : ModeChange::frameBegins, facts);
  setMode(step, mode);
  if (facts.fast) {
    for (const std::int32_t block : step.blocks) step.engine.memo.blockHistory[static_cast<std::size_t>(block)].hasFallen = true;
  }
  if (mode == IslandMode::implicit) {
    outcome = runImplicitSteps(step, facts.mostlyFallen, begin_s);
    if (!outcome.inside || begin_s >= step.part.end_s) return outcome;
    facts.stands = stands(step, facts);
    mode = nextMode(ModeChange::implicitFailed, facts);
    if (mode == IslandMode::rigid) {
      if (facts.rigidBefore) begin_s = takeBackImplicitSteps(step);
      setMode(step, mode);
    } else {  // implicit steps are tried again in the next frame
      for (const std::int32_t block : step.blocks)
        step.engine.memo.islandHistory[static_cast<std::size_t>(block)].explicitFrames = 0;
    }
  }
  const int before = outcome.substeps;
  outcome = mode == IslandMode::rigid ? runRigidMode(step, begin_s) : runExplicitSteps(step, begin_s);
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
  return runExplicitSteps(step, step.part.begin_s);
}

}  // namespace springtower
