#pragma once

#include "narrowphase/near_points.h"
#include "solver/world/island_step.h"

#include <array>
#include <cstddef>
#include <limits>

namespace springtower {

// Coulomb's law with two coefficients holds for a contact, not for its points: these are the corners of a face that lets go as
// one. A point at its limit keeps static friction while any other of its contact sticks. Contacts are looked at between steps, so
// that friction does not jump within one.
//
// A contact that slips as a whole is braked as by pressure that is spread evenly over it. What holds one that sticks is what its
// corners hold.

/// The slip of a contact's points, taken together.
struct SlipOfPoints {
  bool pushes = false;                                           ///< whether any pushes
  bool sticks = false;                                           ///< whether any that pushes sticks
  double pushing_m_s = std::numeric_limits<double>::infinity();  ///< least slip speed of those that push
  double any_m_s = std::numeric_limits<double>::infinity();      ///< and of all

  void add(bool pushesThere, bool slipsThere, double speed_m_s);
  /// Whether the contact slips as a whole: all points that push have slipped, and faster than tuning::kGrossSlipSpeed and than
  /// `least_m_s`. Of a contact that has not pushed yet the speeds alone decide.
  [[nodiscard]] bool isGross(const Simulation& simulation, double least_m_s = 0.0) const;
};

/// Slip speed of points in passes over impulses that is not slip, m/s: what they leave of the speed that gravity gives in a step.
double slipNoise_m_s(const IslandStep& step);

/// Points of a contact with the forces (or impulses) along its normal; those that push.
struct PatchPoints {
  std::array<Vec3, kMostNearPoints> place;
  std::array<double, kMostNearPoints> push{};
  std::size_t count = 0;
  void add(const Vec3& there, double pushThere) {
    if (!(pushThere > 0.0) || count == kMostNearPoints) return;
    place[count] = there;
    push[count++] = pushThere;
  }
};

/// Where the friction of these points has to act so that a face that turns is braked as by even pressure: at `shrink` times their
/// distance from the centre of pressure. That is the mean distance from there over the polygon of the points, over their own mean
/// distance: with it, four corners of a rectangle are nearly the places of Gauss's quadrature.
struct EvenPressure {
  Vec3 centre = Vec3::Zero();  ///< m
  double shrink = 1.0;
  double radius_m = 0.0;  ///< mean distance of the points from the centre
};
/// `normal`: unit, of the contact. One point, or none, is left where it is; of points on a line it is a half.
EvenPressure evenPressure(const PatchPoints& points, const Vec3& normal);

/// The factor by which friction is to act nearer to the centre on a contact that turns by `spin_rad_s` about its normal and
/// slides by `slide_m_s` at its centre of pressure: `pressure.shrink` where it turns, 1 where it all but slides. There the
/// difference would be small, and where friction acts would follow the pressure with the delay of a step.
double shrinkOf(const EvenPressure& pressure, double spin_rad_s, double slide_m_s);

/// Before a step of springs: finds out which contacts of the island slip as a whole, from the state of their points after the
/// step before and from the present velocities, and where friction acts on these. Returns whether there are others than before.
bool findSlippingContacts(IslandStep& step);

}  // namespace springtower
