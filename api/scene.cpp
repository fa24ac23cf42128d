#include "api/convert.h"
#include "core/limits.h"
#include "core/scene/corners.h"
#include "scenarios/registry.h"

#include <fmt/format.h>
#include <springtower/scene.h>

namespace springtower::api {
namespace {

// A scene as worlds take it: they play no moves.
Scene withoutMoves(const springtower::Scene& scene, const std::string& source) {
  if (!scene.moves.empty()) {
    throw InputError(fmt::format("{}: expected a scene without moves, got {} moves of a scripted hand", onOneLine(source),
                                 scene.moves.size()));
  }
  return toPublic(scene);
}

}  // namespace

Scene towerScene(int rows, const TowerOptions& options) {
  return withPublicErrors([&] { return toPublic(springtower::towerScene(rows, toEngine(options))); });
}

Scene bitCodeScene(std::string_view code, const TowerOptions& options) {
  return withPublicErrors([&] { return toPublic(springtower::bitCodeScene(code, toEngine(options))); });
}

Scene sceneFromToml(const std::string& path, const TowerOptions& options) {
  return withPublicErrors([&] { return withoutMoves(springtower::sceneFromToml(path, toEngine(options)), path); });
}

Scene namedScene(const std::string& name, const TowerOptions& options) {
  return withPublicErrors([&] { return withoutMoves(springtower::sceneNamed(name, toEngine(options)), name); });
}

void placeByCorners(Block& block, const std::array<Vec3, 8>& corners) {
  withPublicErrors([&] {
    for (std::size_t c = 0; c < corners.size(); ++c) {
      for (const double x : {corners[c].x, corners[c].y, corners[c].z})
        requireInRange(x, kPlaceRange, fmt::format("placeByCorners: corner {}", c));
    }
  });
  springtower::BlockSpec placed;
  placed.dimensions = toEngine(block.dimensions);
  CornerPlaces places;
  for (std::size_t c = 0; c < places.size(); ++c) places[c] = toEngine(corners[c]);
  springtower::placeByCorners(places, placed);
  const Block of = toPublic(placed);
  block.centre = of.centre;
  block.orientation = of.orientation;
  block.strain_m = of.strain_m;
}

std::vector<ScenarioInfo> scenarioList() {
  std::vector<ScenarioInfo> list;
  for (const springtower::Scenario& scenario : springtower::scenarios()) {
    list.push_back(
        {springtower::usageOf(scenario), std::string(scenario.what), springtower::allowedSizes(scenario), scenario.isTower});
  }
  return list;
}

void checkScene(const Scene& scene) {
  withPublicErrors([&] { springtower::checkScene(toEngine(scene), sourceOf(scene)); });
}

}  // namespace springtower::api
