#pragma once

#include "core/lanes.h"
#include "core/vector.h"

namespace springtower {

/// Four vectors of space, component by component.
struct LaneVector {
  Lanes x;
  Lanes y;
  Lanes z;
};

SPRINGTOWER_INLINE void setZero(LaneVector& to) {
  to.x = to.y = to.z = Lanes{0.0, 0.0, 0.0, 0.0};
}
SPRINGTOWER_INLINE void add(const LaneVector& v, LaneVector& to) {
  to.x += v.x;
  to.y += v.y;
  to.z += v.z;
}
SPRINGTOWER_INLINE void subtract(const LaneVector& v, LaneVector& from) {
  from.x -= v.x;
  from.y -= v.y;
  from.z -= v.z;
}
SPRINGTOWER_INLINE void addTimes(const Lanes& factor, const LaneVector& v, LaneVector& to) {
  to.x += factor * v.x;
  to.y += factor * v.y;
  to.z += factor * v.z;
}
SPRINGTOWER_INLINE void subtractTimes(const Lanes& factor, const LaneVector& v, LaneVector& from) {
  from.x -= factor * v.x;
  from.y -= factor * v.y;
  from.z -= factor * v.z;
}
SPRINGTOWER_INLINE void dot(const LaneVector& a, const LaneVector& b, Lanes& to) {
  to = (a.x * b.x + a.y * b.y) + a.z * b.z;
}
SPRINGTOWER_INLINE void cross(const LaneVector& a, const LaneVector& b, LaneVector& to) {
  const Lanes x = a.y * b.z - a.z * b.y;
  const Lanes y = a.z * b.x - a.x * b.z;
  to.z = a.x * b.y - a.y * b.x;
  to.x = x;
  to.y = y;
}
/// What lies along a unit vector is taken away.
SPRINGTOWER_INLINE void removeAlong(const LaneVector& direction, LaneVector& from) {
  Lanes along;
  dot(from, direction, along);
  subtractTimes(along, direction, from);
}
SPRINGTOWER_INLINE void setLane(LaneVector& to, int lane, const Vec3& vector) {
  to.x[lane] = vector[0];
  to.y[lane] = vector[1];
  to.z[lane] = vector[2];
}
SPRINGTOWER_INLINE void getLane(const LaneVector& from, int lane, Vec3& vector) {
  vector = {from.x[lane], from.y[lane], from.z[lane]};
}

/// Four vectors, each in the first three lanes of a pack, to components.
SPRINGTOWER_INLINE void transpose(const Lanes& a, const Lanes& b, const Lanes& c, const Lanes& d, LaneVector& to) {
  Lanes evenAb, oddAb, evenCd, oddCd;
  shuffle<0, 4, 2, 6>(a, b, evenAb);
  shuffle<1, 5, 3, 7>(a, b, oddAb);
  shuffle<0, 4, 2, 6>(c, d, evenCd);
  shuffle<1, 5, 3, 7>(c, d, oddCd);
  shuffle<0, 1, 4, 5>(evenAb, evenCd, to.x);
  shuffle<0, 1, 4, 5>(oddAb, oddCd, to.y);
  shuffle<2, 3, 6, 7>(evenAb, evenCd, to.z);
}
/// The inverse; the fourth lanes become zero.
SPRINGTOWER_INLINE void transpose(const LaneVector& from, Lanes& a, Lanes& b, Lanes& c, Lanes& d) {
  const Lanes zero = {0.0, 0.0, 0.0, 0.0};
  Lanes evenXy, oddXy, evenZ, oddZ;
  shuffle<0, 4, 2, 6>(from.x, from.y, evenXy);
  shuffle<1, 5, 3, 7>(from.x, from.y, oddXy);
  shuffle<0, 4, 2, 6>(from.z, zero, evenZ);
  shuffle<1, 5, 3, 7>(from.z, zero, oddZ);
  shuffle<0, 1, 4, 5>(evenXy, evenZ, a);
  shuffle<0, 1, 4, 5>(oddXy, oddZ, b);
  shuffle<2, 3, 6, 7>(evenXy, evenZ, c);
  shuffle<2, 3, 6, 7>(oddXy, oddZ, d);
}

/// Lane by lane.
SPRINGTOWER_INLINE void largerOf(const Lanes& a, const Lanes& b, Lanes& to) {
  to = a > b ? a : b;
}
SPRINGTOWER_INLINE void smallerOf(const Lanes& a, const Lanes& b, Lanes& to) {
  to = a < b ? a : b;
}
SPRINGTOWER_INLINE void sizeOf(const Lanes& v, Lanes& to) {
  to = v < 0.0 ? -v : v;
}
SPRINGTOWER_INLINE bool any(const LaneMask& mask) {
  return ((mask[0] | mask[1]) | (mask[2] | mask[3])) != 0;
}
/// Number of lanes that are set.
SPRINGTOWER_INLINE int count(const LaneMask& mask) {
  return -static_cast<int>((mask[0] + mask[1]) + (mask[2] + mask[3]));
}

}  // namespace springtower
