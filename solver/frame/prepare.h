#pragma once

#include "solver/implicit/search_monitor.h"
#include "solver/world/simulation.h"

#include <cstddef>
#include <functional>
#include <limits>

namespace springtower {

/// Limits of `prepare`.
struct PrepareOptions {
  /// s, wall time, 0 or more. Islands whose search is not over by then start as placed: what a scene then does depends on how
  /// fast the machine is.
  double budget_s = std::numeric_limits<double>::infinity();
  /// Called at the beginning and about ten times a second, on whatever thread, one call at a time; false ends the search, as the
  /// budget does. May be empty; must not throw.
  std::function<bool(const PrepareProgress&)> goesOn = {};
};

/// How the search for the equilibria has ended.
enum class PrepareEnd { complete, outOfTime, cancelled };

/// What `prepare` has done.
struct PrepareResult {
  PrepareEnd end = PrepareEnd::complete;
  std::size_t blocks = 0;           ///< awake ones
  std::size_t blocksInBalance = 0;  ///< of islands that start in static equilibrium; the others start as placed
  double wall_s = 0.0;
  double processor_s = 0.0;  ///< of the whole process
};

/// Before the first frame: finds which blocks touch, and puts islands whose blocks all touch and do not move into the static
/// equilibrium next to their placement, where there is one (solver/implicit/equilibrium.h). Every method whose contacts have
/// stiffness starts from it; rigid ones and the 2003 report's start as placed. Frames are refused before this; a second call does
/// nothing. The same bits for any number of threads, unless time runs out. Throws DivergenceError where the search diverges, and
/// InputError for a negative budget.
PrepareResult prepare(Simulation& simulation, const PrepareOptions& options = {});

/// Whether `prepare` has been called.
bool isPrepared(const Simulation& simulation);

}  // namespace springtower
