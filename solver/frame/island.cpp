#include "solver/frame/island.h"

#include "solver/contact/rigid_contacts.h"
#include "solver/contact/update.h"
#include "solver/frame/explicit_steps.h"
#include "solver/frame/island_modes.h"
#include "solver/implicit/equilibrium.h"
#include "solver/implicit/run.h"
#include "solver/rigid/run.h"

namespace springtower {

namespace {

// Implicit steps, as far as they fit and converge; then rigid or explicit ones, as the table of island_modes.h has it.
IslandOutcome runByModes(IslandStep& step) {
  const double frame_s = step.simulation.scene.settings.frame_s;
  const IslandFacts facts = islandFacts(step);
  IslandOutcome outcome;
  double begin_s = 0.0;
  IslandMode mode = nextMode(ModeChange::frameBegins, facts);
  setMode(step, mode);
  if (mode == IslandMode::implicit) {
    outcome = runImplicitSteps(step, facts.mostlyFallen, begin_s);
    if (!outcome.inside || begin_s >= frame_s) return outcome;
    mode = nextMode(ModeChange::implicitFailed, facts);
    if (mode == IslandMode::rigid) setMode(step, mode);
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
      return runRigidSteps(step, rigidSubsteps(settings), 0.0);
    case MethodFamily::explicitSprings:
    case MethodFamily::report:
      break;
  }
  return runExplicitSteps(step, 0.0);
}

}  // namespace springtower
