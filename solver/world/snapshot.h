#pragma once

#include "core/counters.h"
#include "core/scene/scene.h"
#include "core/scene/user_force.h"
#include "core/settings.h"
#include "core/state.h"
#include "narrowphase/manifold.h"
#include "solver/law/tether.h"
#include "solver/world/contact_pool.h"
#include "solver/world/memo.h"
#include "solver/world/pair_table.h"
#include "solver/world/report_state.h"
#include "solver/world/simulation.h"
#include "solver/world/sleep_state.h"
#include "solver/world/wake_reason.h"

#include <cstdint>
#include <memory>
#include <string_view>
#include <vector>

namespace springtower {

class ByteReader;
class ByteWriter;

/// All that the next frames of a simulation depend on beside its model, which the scene decides. What a frame reads and this does
/// not hold is scratch, which each frame writes first (docs/adr/0003-ownership.md).
struct Snapshot {
  // Inputs.
  Gravity gravity;
  std::vector<UserForce> forces;
  double staticFriction;
  double kineticFriction;
  Sleep sleep;
  Tether tether;
  // State.
  MotionState state;
  double time_s;
  std::uint64_t frame;
  std::vector<std::uint8_t> asleep;
  std::vector<double> restTime_s;
  PairTable pairs;
  ContactPool contacts;
  std::vector<SlipPatch> patches;  ///< [pairs]: where friction acts on contacts that slip, of which a copied pool has none
  SleepState sleepState;
  ReportState report;
  // Whatever else the next frame depends on, and the counters.
  Memo memo;
  int substeps;
  Counters counters;
  StageTimes stageTimes;
  WakeCounts wakes;
};

/// Writes a snapshot as bytes, every bit of it.
void writeSnapshot(const Snapshot& snapshot, ByteWriter& writer);

/// Reads it again, perhaps in another process: from it a simulation of the same scene goes on bit for bit. Throws InputError
/// where the bytes end early or cannot be those of a snapshot. Contacts have other rows of their pool than they had, on which
/// nothing depends.
std::shared_ptr<const Snapshot> readSnapshot(ByteReader& reader);

/// Throws InputError naming `source` unless a snapshot is of as many blocks as a simulation has.
void checkFits(const Snapshot& snapshot, const Simulation& simulation, std::string_view source);

}  // namespace springtower
