#include "tests/pinned/pinned_scene.h"

#include <iterator>
#include <utility>

namespace springtower {

std::vector<PinnedScene> pinnedScenes() {
  std::vector<PinnedScene> all;
  for (const auto group : {pinnedGates, pinnedRests, pinnedFalls, pinnedLarge, pinnedHands, pinnedMethods}) {
    std::vector<PinnedScene> scenes = group();
    all.insert(all.end(), std::make_move_iterator(scenes.begin()), std::make_move_iterator(scenes.end()));
  }
  return all;
}

Scene sceneOfFile(const std::string& name) {
  return sceneFromToml(std::string(SPRINGTOWER_SOURCE_DIR) + "/scenes/" + name + ".toml");
}

}  // namespace springtower
