#pragma once

#include "core/scene/scene.h"
#include "scenarios/towers.h"
#include "solver/world/simulation.h"

#include <functional>
#include <string>
#include <vector>

namespace springtower {

/// Acts on a simulation before each of its frames: a hand, a kick, a force. What it needs from frame to frame it stores itself,
/// so each run has one of its own.
using Leader = std::function<void(Simulation&)>;

/// A scene whose every bit is pinned (tests/data/pinned.json).
struct PinnedScene {
  std::string name;  ///< letters and digits: tests and pins are found by it
  int frames = 0;    ///< frames played, also where the leader goes back to an earlier state
  std::function<Scene()> scene;
  std::function<Leader()> leader = {};  ///< empty: nothing acts
};

/// All of them.
std::vector<PinnedScene> pinnedScenes();

// By what they are about; each is one file.
std::vector<PinnedScene> pinnedGates();    ///< those of bench/gate_scenes.cpp (scenarios/gate.h)
std::vector<PinnedScene> pinnedRests();    ///< what stands or leans, awake and asleep
std::vector<PinnedScene> pinnedFalls();    ///< what drops, flies and collapses
std::vector<PinnedScene> pinnedLarge();    ///< many blocks: one large island, many small ones
std::vector<PinnedScene> pinnedHands();    ///< hands, kicks and scripted moves
std::vector<PinnedScene> pinnedMethods();  ///< every method, and settings that choose another way through the code

/// One of the files of scenes/, by its name without ".toml".
Scene sceneOfFile(const std::string& name);

}  // namespace springtower
