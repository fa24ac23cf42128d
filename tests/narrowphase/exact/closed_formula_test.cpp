#include "narrowphase/exact/cubic.h"
#include "narrowphase/exact/query_set.h"

#include <array>
#include <cmath>
#include <gtest/gtest.h>
#include <numbers>
#include <string>
#include <vector>

namespace springtower {
namespace {

// The real roots of a t^3 + b t^2 + c t + d as in the report (its 4.4): in closed form, in double precision.
std::vector<double> rootsInClosedForm(const std::array<double, 4>& power) {
  const auto& [a, b, c, d] = power;
  const double p = c / a - b * b / (3.0 * a * a);
  const double q = 2.0 * b * b * b / (27.0 * a * a * a) - b * c / (3.0 * a * a) + d / a;
  const double shift = -b / (3.0 * a);
  const double discriminant = 0.25 * q * q + p * p * p / 27.0;
  if (discriminant > 0.0)
    return {std::cbrt(-0.5 * q + std::sqrt(discriminant)) + std::cbrt(-0.5 * q - std::sqrt(discriminant)) + shift};
  const double size = 2.0 * std::sqrt(-p / 3.0);
  const double angle = std::acos(1.5 * q / p * std::sqrt(-3.0 / p)) / 3.0;
  std::vector<double> roots;
  for (int k = 0; k < 3; ++k) roots.push_back(size * std::cos(angle - 2.0 * std::numbers::pi * k / 3.0) + shift);
  return roots;
}

// "Occasionally a block can become embedded with another block causing the blocks to stretch apart: this problem is down to
// numerical accuracy" (report 6.2.2). Where faces or edges move nearly in one plane the closed form loses the time of contact,
// and blocks whose contact was missed are inside one another. The queries are those of blocks in stacks and of degenerate cases.
TEST(ReportFailure, TheClosedFormulaLosesCollisionsThatEmbedBlocks) {
  std::size_t lost = 0;
  std::size_t missed = 0;
  std::size_t meeting = 0;
  const std::string folder = std::string(SPRINGTOWER_TEST_DATA_DIR) + "/ccd/";
  for (const char* set : {"synthetic-sim", "degenerate"}) {
    for (const QueryKind kind : {QueryKind::pointTriangle, QueryKind::edgeEdge}) {
      for (const CollisionQuery& query :
           readCollisionQueries(folder + set + (kind == QueryKind::pointTriangle ? "/vf.csv" : "/ee.csv"))) {
        if (!query.exact.hit) continue;
        ++meeting;
        const auto& [a, b, c, d] = query.points;
        bool found = false;
        for (const double root : rootsInClosedForm(powerCoefficients(coplanarityCubic(a, b, c, d))))
          found = found || std::abs(root - query.exact.time) < 1e-3;
        lost += found ? 0 : 1;
        missed += answer(query, kind).hit ? 0 : 1;
      }
    }
  }
  EXPECT_GT(lost, meeting / 5);
  EXPECT_EQ(missed, 0U) << "ours";
}

}  // namespace
}  // namespace springtower
