#pragma once

#include "core/counters.h"
#include "narrowphase/separation.h"

namespace springtower {

/// A block's corners at the start and at the end of a step; between them each moves in a straight line (report 4.4).
struct MovingBlock {
  CornerView start;
  CornerView end;
};

/// Whether any corner of one block touches a face triangle of the other, or any two edges touch, within a step: all 192
/// point-face and 144 edge-edge pairs, culled in the report's stages (swept boxes, coplanarity, the full cubic test; Table 5.2),
/// each counted. Stops at the first pair that touches. Conservative: never misses (narrowphase/exact/time_of_impact.h).
bool featuresMeet(const MovingBlock& a, const MovingBlock& b, Counters& counters);

}  // namespace springtower
