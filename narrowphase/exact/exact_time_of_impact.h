#pragma once

#include "narrowphase/exact/moving_point.h"

namespace springtower {

struct TimeOfImpact;

/// The same results as the functions of time_of_impact.h, determined without any rounding, for every finite input. A few
/// microseconds, up to 50 for coplanar motion; milliseconds only where coordinates differ by hundreds of powers of ten. Allocates
/// nothing, but takes about 250 kB of stack. A coordinate that is not finite gives a hit at 0, since nothing can be excluded.
///
/// Both tests are one: whether the origin is in a moving planar polygon, the differences of the two features (triangle minus
/// point; edge minus edge, a parallelogram). Coordinates become integers of one common unit, so the coplanarity cubic and all
/// other conditions are polynomials in time with integer coefficients.
/// - Candidate times: the roots of the cubic in [0, 1]. If it is identically zero: t = 0 and the roots of all conditions below,
/// since between two neighbouring ones no condition changes its sign.
/// - At a candidate the origin and the polygon lie in one plane. The polygon then contains the origin if and only if in no
/// coordinate all vertices are on one side of it, and in no coordinate plane there are both left and right turns (vertex i,
/// vertex i + 1, origin).
/// - Signs at a root are found by refining its interval; common roots by remainders. Multiple roots are rational and found as
/// such. The time is the exact one, rounded down to a double.
TimeOfImpact exactPointTriangleTimeOfImpact(const MovingPoint& point, const MovingPoint& a, const MovingPoint& b,
                                            const MovingPoint& c);
TimeOfImpact exactEdgeEdgeTimeOfImpact(const MovingPoint& a, const MovingPoint& b, const MovingPoint& c, const MovingPoint& d);

}  // namespace springtower
