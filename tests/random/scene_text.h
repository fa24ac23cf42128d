#pragma once

#include "scenarios/random_scene.h"

#include <string>
#include <string_view>

namespace springtower {

/// A scene as a TOML file that reads as the same scene to the last bit (orientations: see rotationOfOrientation). `comment` goes
/// into its first line. Settings that are the default are left out. Preconditions: checkScene accepts the scene, and blocks with
/// a row are those of the tower of `random.towerCode`.
std::string sceneText(const RandomScene& random, std::string_view comment);

}  // namespace springtower
