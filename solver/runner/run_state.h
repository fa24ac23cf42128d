#pragma once

#include "core/scene/scene.h"
#include "core/state.h"
#include "solver/hand/moves.h"
#include "solver/metrics/measures.h"
#include "solver/world/snapshot.h"

#include <cstddef>
#include <iosfwd>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace springtower {

/// What decides how a run goes on beside its simulation: its moves, and whether the scene has fallen, which ends them.
struct RunProgress {
  MoveRun moves;
  std::vector<FittedBox> reference;  ///< where each block has to be to stand, [blocks]
  std::size_t laid = 0;              ///< how many of moves.laid the reference has taken over
  Standing standing;                 ///< the first fall, or that the scene stands
  std::optional<double> fallTime_s;  ///< first frame in which it had fallen
};

/// A run that another process may go on with: the scene as it was given, from which the simulation is made again, and all that
/// has become of it.
struct SavedRun {
  Scene scene;
  std::shared_ptr<const Snapshot> snapshot;
  RunProgress progress;
};

/// Writes a run as a sealed file (core/byte_stream.h): some ten kilobytes a block.
void writeRun(const SavedRun& run, std::ostream& stream);

/// A saved run, and the commit whose program saved it.
struct LoadedRun {
  SavedRun run;
  std::string commit;
};

/// Reads one again. Throws InputError naming `source`, what is expected and what it got for a file that cannot be read, is none
/// of these, or is damaged.
LoadedRun readRun(const std::string& path, const std::string& source);

}  // namespace springtower
