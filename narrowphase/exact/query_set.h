#pragma once

#include "narrowphase/exact/moving_point.h"
#include "narrowphase/exact/time_of_impact.h"

#include <array>
#include <string>
#include <vector>

namespace springtower {

enum class QueryKind { pointTriangle, edgeEdge };

/// One continuous collision query with its exact result.
struct CollisionQuery {
  std::string id;
  std::string scene;                  ///< the scene or the family of cases that it comes from
  TimeOfImpact exact;                 ///< the exact time, rounded to the nearest double; 1 if there is no hit
  double smallestDistance;            ///< between the features over the step; 0 if there is a hit
  std::array<MovingPoint, 4> points;  ///< point and triangle a b c, or edges a-b and c-d
};

/// Reads a set of queries: comma-separated, one header line with the 32 columns id, set, src, family, gt, toi, min_dist, gt_f32,
/// a0x a0y a0z b0x ... d0z (at t = 0), a1x ... d1z (at t = 1), then one query a line. Throws InputError with the file, the line,
/// what is expected and what it got.
std::vector<CollisionQuery> readCollisionQueries(const std::string& path);

/// The result of time_of_impact.h for a query.
TimeOfImpact answer(const CollisionQuery& query, QueryKind kind, DecidedBy* decidedBy = nullptr);

/// Errors of a result.
struct QueryMistakes {
  bool missed;            ///< a hit, more than one unit in the last place later than the exact time
  bool late;              ///< a hit, more than one unit in the last place after the exact time
  bool falseHit;          ///< a hit, but the features never meet
  bool falseBeyondError;  ///< and are never within the stated error (kContactError) either
};

QueryMistakes judge(const CollisionQuery& query, const TimeOfImpact& answer);

}  // namespace springtower
