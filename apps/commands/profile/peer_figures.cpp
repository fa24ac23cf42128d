#include "apps/commands/profile/peer_figures.h"

#include "apps/common/interruption.h"
#include "core/error.h"
#include "solver/metrics/measures.h"
#include "solver/metrics/penetration.h"
#include "solver/runner/run.h"

#include <algorithm>
#include <numeric>

namespace springtower {
namespace {

constexpr int kPeerFrames = 60;       // of a run: a simulated second, in which a stack has sunk and its lowest blocks have met
constexpr int kLeastPeerFrames = 10;  // in less time a stack has not yet sunk
constexpr int kLeastPeerSteps = 4;
constexpr int kMaxPeerSteps = 256;

// One run, which ends when a stack has fallen, or after `limit_s` of processor time.
PeerFigures runPeer(Peer peer, int substeps, const Simulation& simulation, int fallFrames, double limit_s) {
  const Scene& scene = simulation.scene;
  const bool falls = fallFrames > 0;
  PeerProcess process(peer, {substeps, 0}, scene);
  MotionState state;
  state.resize(scene.blocks.size());
  PenetrationWorkspace workspace;
  std::vector<double> times_s;
  std::vector<double> depths_m;
  double spent_s = 0.0;
  const Simulation fresh(scene);
  const std::vector<FittedBox> start = fittedBoxes(fresh.state.position);
  bool stands = true;
  const int frames = falls ? fallFrames : kPeerFrames;
  for (int frame = 0; (stands || falls) && frame < frames && (frame < kLeastPeerFrames || spent_s < limit_s); ++frame) {
    endIfInterrupted();
    times_s.push_back(process.step(state));
    spent_s += times_s.back();
    depths_m.push_back(maxPenetration(state.position, scene.floor, workspace).depth);
    if (!falls) stands = standing(simulation.model, start, state.position).stands;
  }
  PeerFigures figures;
  figures.engine = nameOf(peer);
  figures.substeps = substeps;
  figures.frame_ms = 1e3 * quantile(times_s, 0.5);
  figures.worst_ms = 1e3 * *std::max_element(times_s.begin() + (times_s.size() > 1 ? 1 : 0), times_s.end());
  const auto half = depths_m.begin() + static_cast<std::ptrdiff_t>(falls ? 0 : depths_m.size() / 2);
  figures.penetration_mm = 1e3 * *std::max_element(half, depths_m.end());
  figures.simulated_s = static_cast<double>(times_s.size()) * scene.settings.frame_s;
  figures.stands = stands;
  return figures;
}

}  // namespace

std::vector<PeerFigures> measurePeer(Peer peer, const Simulation& simulation, const PeerRun& run,
                                     const std::function<void()>& beforeRun) {
  const std::vector<Peer> here = peersHere();
  std::vector<PeerFigures> all;
  if (run.limit_s <= 0.0 || std::find(here.begin(), here.end(), peer) == here.end()) return all;
  double left_s = run.limit_s;
  for (int substeps = kLeastPeerSteps; substeps <= kMaxPeerSteps; substeps *= 2) {
    beforeRun();
    try {
      all.push_back(runPeer(peer, substeps, simulation, run.fallFrames, left_s));
    } catch (const DivergenceError&) {
      continue;
    }
    const PeerFigures& last = all.back();
    if (last.penetration_mm <= run.penetration_mm) break;
    left_s -= 1e-3 * last.frame_ms * last.simulated_s / simulation.scene.settings.frame_s;
    // Twice as many steps take twice as long.
    if (2e-3 * last.frame_ms * kLeastPeerFrames > left_s) break;
  }
  return all;
}

}  // namespace springtower
