#pragma once

#include "narrowphase/exact/cubic.h"
#include "narrowphase/exact/moving_point.h"

namespace springtower {

/// Whether two moving features touch or cross within a step, and the first time: `time` in [0, 1], 1 if there is no hit.
struct TimeOfImpact {
  bool hit;
  double time;
};

/// The stage that decided a query, in the order of evaluation; for counting.
enum class DecidedBy {
  boxes,       ///< the swept boxes do not meet
  cubic,       ///< the coplanarity cubic has no root in [0, 1]
  refinement,  ///< root isolation in floating point with error bounds
  exact        ///< exact arithmetic (exact_time_of_impact.h)
};

/// The stated error e of a time of impact: at the reported time the features are at most kContactError times the query's size
/// (queryExtent) apart. `hit` itself has no error: the hits are exactly the queries in which the closed features share a point at
/// some time in [0, 1], for all finite coordinates.
constexpr double kContactError = 1e-10;

/// First time at which a moving point and a moving triangle a b c share a point (report 4.4.1).
/// - Never misses: touching counts, and so do degenerate triangles, coplanar motion, zero motion, contact at t = 0 and t = 1.
/// - Never late: `time` is not after the exact time, and earlier by at most the time in which the features move by kContactError.
/// - Does not depend on the order of a, b, c, apart from an error of that size in `time`.
/// Coordinates may be any numbers; if one of them is not finite, nothing can be excluded and the result is a hit at 0. The
/// rounding mode must be to nearest. Takes no locks, allocates nothing, has no state. Method: the culls; then the cubic's
/// roots are isolated by Bezier clipping and bisection, and each part of the step is discarded if a fixed axis separates the
/// features throughout; a certified simple crossing is a hit; cases that doubles cannot decide go to exact arithmetic.
/// `decidedBy` may be null.
TimeOfImpact pointTriangleTimeOfImpact(const MovingPoint& point, const MovingPoint& a, const MovingPoint& b, const MovingPoint& c,
                                       DecidedBy* decidedBy = nullptr);

/// First time at which two moving edges a-b and c-d share a point (report 4.4.2). As above, including parallel and collinear
/// edges and edges of zero length.
TimeOfImpact edgeEdgeTimeOfImpact(const MovingPoint& a, const MovingPoint& b, const MovingPoint& c, const MovingPoint& d,
                                  DecidedBy* decidedBy = nullptr);

}  // namespace springtower
