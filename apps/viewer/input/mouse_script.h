#pragma once

#include "apps/viewer/input/controls.h"

#include <cstdint>
#include <string>
#include <vector>

namespace springtower {

// A mouse that follows a file, for films and pictures without a display.

/// What happens when the mouse has come to a place.
enum class MouseAct { none, press, release, hints, skip };

/// Where the mouse is in a picture, and what it does there.
struct MouseStep {
  std::uint64_t picture = 0;
  double x = 0.0;  ///< pixels
  double y = 0.0;
  MouseAct act = MouseAct::none;
};

/// Reads one: a step a line, PICTURE X Y and perhaps press, release (of the left button), hints (shown or not) or skip (the rest
/// of a fall); the pictures ascend. Empty lines and those that begin with # do not count. Throws InputError naming the file, the
/// line, what is expected and what it got.
std::vector<MouseStep> readMouseScript(const std::string& path);

/// Where the mouse is in a picture: on a straight line between two steps. Precondition: at least one step.
Eigen::Vector2d mouseAt(const std::vector<MouseStep>& script, std::uint64_t picture);

/// What it does in a picture, in order.
std::vector<MouseAct> mouseActs(const std::vector<MouseStep>& script, std::uint64_t picture);

}  // namespace springtower
