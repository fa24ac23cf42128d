#include "tests/pinned/pinned_scene.h"
#include "tests/support/block_scenes.h"

namespace springtower {
namespace {

Scene swayingTower() {
  return swaying(awake(towerScene(18)), 0.1, 2.0);
}

Scene unevenTower() {
  TowerOptions options;
  options.heightsSigma_m = kUnevenHeightsSigma_m;
  options.massSigma_kg = 0.002;
  options.seed = 3;
  return towerScene(6, options);
}

// A block slides down a slope, with less friction than it needed to begin.
Scene slidingBlock() {
  Scene scene = awake(sceneOfFile("block_on_slope"));
  scene.gravity.tilt_deg = 23.0;
  scene.kineticFriction = 0.3;
  return scene;
}

// All asleep, a weak force wakes one block; then a strong one draws it out, and others wake.
Scene pulledAsleep() {
  Scene scene = towerScene(5);
  scene.forces.push_back(constantForce(4, -1, Vec3(0.0, 0.002, 0.0), 3.2, 3.4));
  scene.forces.push_back(constantForce(4, -1, Vec3(0.0, 4.0, 0.0), 3.8, 3.85));
  return scene;
}

Scene swayThatWakes() {
  return swaying(towerScene(2), 0.5, 0.05);
}

Scene cornerForce() {
  Scene scene = towerScene(3);
  scene.forces.push_back(constantForce(7, 6, Vec3(0.1, 0.05, -0.1), 0.1, 0.6));
  return scene;
}

// The report's rule for sleep, which judges by travel alone.
Scene asleepByTheReportsRule() {
  Scene scene = towerScene(4);
  scene.settings.sleep = Sleep::report;
  return scene;
}

}  // namespace

std::vector<PinnedScene> pinnedRests() {
  std::vector<PinnedScene> scenes = {
      {"TowerFallsAsleep", 240, [] { return towerScene(18); }},
      {"UnevenTowerFallsAsleep", 240, unevenTower},
      {"UnevenTowerAwake", 120, [] { return awake(unevenTower()); }},
      {"TallTowerAwake", 40, [] { return awake(towerScene(60)); }},
      {"SwayingTower", 120, swayingTower},
      {"SwayThatWakes", 480, swayThatWakes},
      {"PulledAsleep", 300, pulledAsleep},
      {"CornerForce", 60, cornerForce},
      {"SlidingBlock", 60, slidingBlock},
      {"AsleepByTheReportsRule", 120, asleepByTheReportsRule},
      {"Prototypes", 150, [] { return sceneOfFile("prototypes"); }},
  };
  for (const char* name : {"1", "2", "2_out", "3", "4", "5", "6"}) {
    const std::string file = std::string("report_t") + name;
    std::string end = name;
    if (end == "2_out") end = "2Out";
    scenes.push_back({"ReportT" + end, 120, [file] { return sceneOfFile(file); }});
  }
  return scenes;
}

}  // namespace springtower
