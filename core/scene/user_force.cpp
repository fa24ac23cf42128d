#include "core/scene/user_force.h"

#include <algorithm>

namespace springtower {

Load UserForce::at(double time_s) const {
  const double length_s = end_s - start_s;
  const double share = length_s > 0.0 ? std::clamp((time_s - start_s) / length_s, 0.0, 1.0) : 0.0;
  Load load{force, torque};
  if (forceAtEnd) load.force += share * (*forceAtEnd - force);
  if (torqueAtEnd) load.torque += share * (*torqueAtEnd - torque);
  return load;
}

// What changes linearly has its mean at the middle of the time.
Load UserForce::meanOver(double begin_s, double until_s) const {
  const double from_s = std::max(begin_s, start_s);
  const double to_s = std::min(until_s, end_s);
  if (!(from_s < to_s)) return {};
  const Load middle = at(0.5 * (from_s + to_s));
  const double share = (to_s - from_s) / (until_s - begin_s);
  return {share * middle.force, share * middle.torque};
}

}  // namespace springtower
