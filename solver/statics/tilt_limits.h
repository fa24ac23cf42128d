#pragma once

#include "solver/statics/model.h"

#include <span>
#include <vector>

namespace springtower {

using Vec2 = Eigen::Vector2d;

/// A linear limit on the slope of gravity: direction . slope <= bound. The slope is the horizontal part of gravity over its
/// vertical part; its length is the tangent of the tilt.
struct GravityLimit {
  Vec2 direction = Vec2::UnitX();  ///< unit
  double bound = 0.0;
};

/// Limits on the slope of gravity that hold for every equilibrium, in closed form; necessary, not sufficient. Each belongs to a
/// group of blocks that may tip over an edge as one body: its weight must not pass the edge if no contact with the rest can hold
/// it back, that is, if each of these contacts pushes upwards and lies behind the edge by more than friction times its height
/// difference to the edge. The groups are all blocks above a level, and these together with the blocks on which they would tip,
/// one level after the other. If the former rest on flat contacts, their friction is a limit as well.
std::vector<GravityLimit> gravityLimits(const StaticsModel& model, std::span<const std::size_t> usable);

/// The part of a convex polygon within a limit (Sutherland & Hodgman 1974).
std::vector<Vec2> keepTo(const std::vector<Vec2>& polygon, const GravityLimit& limit);

}  // namespace springtower
