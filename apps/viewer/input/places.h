#pragma once

#include "apps/viewer/session/footprint.h"

#include <span>
#include <vector>

namespace springtower {

// Where a carried block may lie down. All are functions of poses.

inline constexpr double kRoomBeside_m = 0.002;  ///< between a block that goes up or down and what stands beside it

/// A pose: where a block's centre is, m, and from its axes to the world's, unit.
struct Place {
  Vec3 centre = Vec3::Zero();
  Eigen::Quaterniond turn = Eigen::Quaterniond::Identity();
};

/// The free places of the uppermost row of a tower for one of its blocks: those that are left in a row of less than three, else
/// the three of a new row across the uppermost one. They lie on the blocks of the row below as these lie, and keep
/// tuning::kPlaceGap_m from blocks already in the row where there is room. Each has of two orientations the one nearer to `turn`.
/// Blocks of other dimensions than the held one are no part of the tower; empty where no row of three of its own kind is found.
std::vector<Place> topPlaces(const ParticleArray& position, std::span<const Vec3> dimensions, std::size_t held,
                             const Eigen::Quaterniond& turn);

/// Where a block would lie, and what becomes of it.
struct Landing {
  Place place;
  bool inRow = false;  ///< it is one of topPlaces
  bool fits = false;   ///< it would rest: what is under it reaches round its middle; otherwise it hangs over and tips
};

/// Where a block lies that is laid down at a place, of which the height does not count: at the nearest of `rowPlaces` in reach,
/// or else straight below. `keepTurn`: places of a row in another direction than the block's do not count.
Landing landingAt(std::span<const Footprint> all, std::span<const Vec3> dimensions, std::size_t held, const Place& over,
                  std::span<const Place> rowPlaces, bool keepTurn);

}  // namespace springtower
