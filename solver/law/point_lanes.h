#pragma once

#include "core/lanes.h"
#include "narrowphase/manifold.h"

namespace springtower {

/// State and forces of four points of a manifold, in the form that the contact law works on.
struct PointLanes {
  Lanes displacement[3];
  Lanes maxwellDepth, restDepth, stiffening, touching, slipRatio;
  Lanes force[3];
  Lanes normalForce;
};

/// Loads a row of points, and stores it.
SPRINGTOWER_INLINE void loadPoints(const PenaltyRow& row, PointLanes& p) {
  load(row.displacement[0].data(), p.displacement[0]);
  load(row.displacement[1].data(), p.displacement[1]);
  load(row.displacement[2].data(), p.displacement[2]);
  load(row.maxwellDepth.data(), p.maxwellDepth);
  load(row.restDepth.data(), p.restDepth);
  load(row.stiffening.data(), p.stiffening);
  load(row.touching.data(), p.touching);
  load(row.slipRatio.data(), p.slipRatio);
}

SPRINGTOWER_INLINE void storePoints(const PointLanes& p, PenaltyRow& row) {
  store(p.displacement[0], row.displacement[0].data());
  store(p.displacement[1], row.displacement[1].data());
  store(p.displacement[2], row.displacement[2].data());
  store(p.maxwellDepth, row.maxwellDepth.data());
  store(p.restDepth, row.restDepth.data());
  store(p.stiffening, row.stiffening.data());
  store(p.touching, row.touching.data());
  store(p.slipRatio, row.slipRatio.data());
}

}  // namespace springtower
