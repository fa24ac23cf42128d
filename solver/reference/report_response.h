#pragma once

#include "solver/world/island_step.h"

#include <cstdint>
#include <span>

namespace springtower {

// Collision response of method `report` (its 4.5): impulses on weighted corners.

/// One side of a collision: a few corners of a block and their weights; block -1 is the floor.
struct ReportSide {
  std::int32_t block;
  std::span<const std::int8_t> corner;
  std::span<const double> weight;
};

/// The sides of a contact; valid as long as the contact is.
ReportSide firstSide(const ReportContact& contact);
ReportSide secondSide(const ReportContact& contact);

/// Whether a side can move: it is neither the floor nor a disabled block.
bool moves(const IslandStep& step, const ReportSide& side);

/// Velocity of the point that a side represents, m/s: the weighted mean of its corners' (report Eq. 4.14); zero where it cannot
/// move.
Vec3 velocityOf(const IslandStep& step, const ReportSide& side);

/// Sets the path of a block with its velocities in this step, for the collision tests.
void layPath(IslandStep& step, std::size_t block);

/// Resolves a collision by an impulse along its normal, with (1 + e) as in Eq. 2.11 and the inverse masses of weighted points in
/// the denominator (report Eq. 4.13 prints (1 - e)), updates the paths, since the report changes the next position at once, and
/// records the contact. Does nothing and returns false if the points already separate: an impulse never pulls. The impulse is
/// stored in `contact`.
bool respond(IslandStep& step, ReportContact& contact);

}  // namespace springtower
