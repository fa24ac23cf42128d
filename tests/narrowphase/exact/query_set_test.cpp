#include "narrowphase/exact/query_set.h"

#include "core/error.h"
#include "core/random.h"
#include "narrowphase/exact/exact_time_of_impact.h"
#include "tests/narrowphase/exact/feature_distance.h"
#include "tests/support/program.h"
#include "tests/support/says.h"

#include <algorithm>
#include <filesystem>
#include <fmt/format.h>
#include <fstream>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <numeric>
#include <ostream>
#include <string>
#include <vector>

namespace springtower {
namespace {

namespace fs = std::filesystem;

struct Set {
  std::string name;
  fs::path folder;
  QueryKind kind;
  std::size_t queries;
  std::size_t meeting;

  std::string path() const { return (folder / (kind == QueryKind::pointTriangle ? "vf.csv" : "ee.csv")).string(); }
};

std::ostream& operator<<(std::ostream& stream, const Set& set) {
  return stream << set.path();
}

// The handcrafted set is not part of the repository; its tests exist only if it is present.
std::vector<Set> sets() {
  const fs::path own = fs::path(SPRINGTOWER_TEST_DATA_DIR) / "ccd";
  std::vector<Set> sets{{"SyntheticPointTriangle", own / "synthetic-sim", QueryKind::pointTriangle, 1910, 124},
                        {"SyntheticEdgeEdge", own / "synthetic-sim", QueryKind::edgeEdge, 2396, 225},
                        {"DegeneratePointTriangle", own / "degenerate", QueryKind::pointTriangle, 401, 241},
                        {"DegenerateEdgeEdge", own / "degenerate", QueryKind::edgeEdge, 449, 267}};
  const std::string shared = SPRINGTOWER_SHARED_DIR;
  const fs::path handcrafted = fs::path(shared) / "data" / "ccd" / "handcrafted";
  if (!shared.empty() && fs::is_directory(handcrafted)) {
    sets.push_back({"HandcraftedPointTriangle", handcrafted, QueryKind::pointTriangle, 1673, 107});
    sets.push_back({"HandcraftedEdgeEdge", handcrafted, QueryKind::edgeEdge, 2456, 111});
  }
  return sets;
}

class QuerySet : public testing::TestWithParam<Set> {};

INSTANTIATE_TEST_SUITE_P(All, QuerySet, testing::ValuesIn(sets()), [](const auto& param) { return param.param.name; });

TimeOfImpact exactAnswer(const CollisionQuery& query, QueryKind kind) {
  const auto& [a, b, c, d] = query.points;
  return kind == QueryKind::pointTriangle ? exactPointTriangleTimeOfImpact(a, b, c, d) : exactEdgeEdgeTimeOfImpact(a, b, c, d);
}

double extentOf(const CollisionQuery& query) {
  const auto& [a, b, c, d] = query.points;
  return queryExtent(a, b, c, d);
}

TEST_P(QuerySet, NoneMissedNoneLateNoneFalse) {
  const std::vector<CollisionQuery> queries = readCollisionQueries(GetParam().path());
  ASSERT_EQ(queries.size(), GetParam().queries);
  std::size_t meeting = 0;
  for (const CollisionQuery& query : queries) {
    const QueryMistakes mistakes = judge(query, answer(query, GetParam().kind));
    EXPECT_FALSE(mistakes.missed || mistakes.late || mistakes.falseHit) << query.id << " of " << query.scene;
    meeting += query.exact.hit;
  }
  EXPECT_EQ(meeting, GetParam().meeting);
}

TEST_P(QuerySet, FeaturesTouchAtTheReportedTimeWithinTheStatedError) {
  for (const CollisionQuery& query : readCollisionQueries(GetParam().path())) {
    const TimeOfImpact impact = answer(query, GetParam().kind);
    if (!impact.hit) continue;
    // In some queries the distance was computed from coordinates far from the origin, and includes their rounding.
    double coordinate = 0.0;
    for (const MovingPoint& point : query.points)
      coordinate = std::max({coordinate, point.start.cwiseAbs().maxCoeff(), point.end.cwiseAbs().maxCoeff()});
    EXPECT_LE(distanceAt(query, GetParam().kind, impact.time), kContactError * extentOf(query) + 1e-14 * coordinate) << query.id;
  }
}

TEST_P(QuerySet, ExactArithmeticAgrees) {
  for (const CollisionQuery& query : readCollisionQueries(GetParam().path())) {
    const TimeOfImpact exact = exactAnswer(query, GetParam().kind);
    const TimeOfImpact impact = answer(query, GetParam().kind);
    EXPECT_EQ(exact.hit, query.exact.hit) << query.id;
    EXPECT_EQ(impact.hit, exact.hit) << query.id;
    if (!exact.hit) continue;
    // Rounded down, where the file has the nearest double.
    EXPECT_LE(exact.time, query.exact.time) << query.id;
    EXPECT_GE(exact.time, std::nextafter(query.exact.time, -1.0)) << query.id;
    EXPECT_LE(impact.time, exact.time) << query.id;
    EXPECT_LE((exact.time - impact.time) * relativeMotion(query, GetParam().kind), kContactError * extentOf(query)) << query.id;
  }
}

TEST_P(QuerySet, ContactDoesNotDependOnTheDirectionOfTime) {
  for (CollisionQuery query : readCollisionQueries(GetParam().path())) {
    for (MovingPoint& point : query.points) std::swap(point.start, point.end);
    EXPECT_EQ(answer(query, GetParam().kind).hit, query.exact.hit) << query.id;
  }
}

TEST_P(QuerySet, AnswersDoNotDependOnTheOrderOfQueries) {
  const std::vector<CollisionQuery> queries = readCollisionQueries(GetParam().path());
  std::vector<TimeOfImpact> inOrder;
  inOrder.reserve(queries.size());
  for (const CollisionQuery& query : queries) inOrder.push_back(answer(query, GetParam().kind));
  std::vector<std::size_t> order(queries.size());
  std::iota(order.begin(), order.end(), 0);
  RandomStream random(7, 0);
  for (std::size_t i = order.size(); i > 1; --i)
    std::swap(order[i - 1], order[static_cast<std::size_t>(random.uniform() * static_cast<double>(i))]);
  for (const std::size_t i : order) {
    const TimeOfImpact again = answer(queries[i], GetParam().kind);
    EXPECT_EQ(again.hit, inOrder[i].hit);
    EXPECT_EQ(again.time, inOrder[i].time);
  }
}

TEST_P(QuerySet, AnswersDoNotDependOnTheOrderOfCorners) {
  // A triangle's corners in all orders; the ends of an edge and the edges themselves.
  using Order = std::array<std::size_t, 4>;
  const std::vector<Order> orders =
      GetParam().kind == QueryKind::pointTriangle
          ? std::vector<Order>{{0, 2, 3, 1}, {0, 3, 1, 2}, {0, 1, 3, 2}, {0, 3, 2, 1}, {0, 2, 1, 3}}
          : std::vector<Order>{{1, 0, 2, 3}, {0, 1, 3, 2}, {1, 0, 3, 2}, {2, 3, 0, 1}, {3, 2, 0, 1}, {2, 3, 1, 0}, {3, 2, 1, 0}};
  for (const CollisionQuery& query : readCollisionQueries(GetParam().path())) {
    const double time = answer(query, GetParam().kind).time;
    CollisionQuery other = query;
    for (const Order& order : orders) {
      for (std::size_t i = 0; i < 4; ++i) other.points[i] = query.points[order[i]];
      const TimeOfImpact impact = answer(other, GetParam().kind);
      EXPECT_EQ(impact.hit, query.exact.hit) << query.id;
      EXPECT_LE(std::abs(impact.time - time) * relativeMotion(query, GetParam().kind), kContactError * extentOf(query))
          << query.id;
    }
  }
}

/// Writes a file for one test and removes it.
class TemporaryFile {
 public:
  explicit TemporaryFile(const std::string& text) { std::ofstream(path_) << text; }

  const std::string& path() const { return path_; }

 private:
  ScratchFolder folder_;
  std::string path_ = folder_.file("queries.csv");
};

const std::string kHeader =
    "id,set,src,family,gt,toi,min_dist,gt_f32,a0x,a0y,a0z,b0x,b0y,b0z,c0x,c0y,c0z,d0x,d0y,d0z,"
    "a1x,a1y,a1z,b1x,b1y,b1z,c1x,c1y,c1z,d1x,d1y,d1z\n";
const std::string kCoordinates = "0.25,0.25,1,0,0,0,1,0,0,0,1,0,0.25,0.25,-1,0,0,0,1,0,0,0,1,0\n";

std::string complaint(const std::string& text) {
  const TemporaryFile file(text);
  try {
    readCollisionQueries(file.path());
  } catch (const InputError& error) {
    std::string message = error.what();
    EXPECT_NE(message.find(file.path()), std::string::npos) << message;
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    return message;
  }
  return "no complaint";
}

TEST(QueryFile, ReadsEveryColumnToItsPlace) {
  const TemporaryFile file(kHeader + "one,some,src#1,deg1,1,0.5,0,1," + kCoordinates + "two,other,src#2,,0,,1.5,0," +
                           kCoordinates);
  const std::vector<CollisionQuery> queries = readCollisionQueries(file.path());
  ASSERT_EQ(queries.size(), 2u);
  EXPECT_EQ(queries[0].id, "one");
  EXPECT_EQ(queries[0].scene, "some");
  EXPECT_TRUE(queries[0].exact.hit);
  EXPECT_EQ(queries[0].exact.time, 0.5);
  EXPECT_EQ(queries[0].points[0].start, Vec3(0.25, 0.25, 1.0));
  EXPECT_EQ(queries[0].points[0].end, Vec3(0.25, 0.25, -1.0));
  EXPECT_EQ(queries[0].points[2].start, Vec3(1.0, 0.0, 0.0));
  EXPECT_EQ(queries[0].points[3].end, Vec3(0.0, 1.0, 0.0));
  EXPECT_FALSE(queries[1].exact.hit);
  EXPECT_EQ(queries[1].smallestDistance, 1.5);
}

TEST(QueryFile, NamesWhatIsWrong) {
  EXPECT_THAT(complaint(""), testing::HasSubstr("expected a header line and at least one query, got no queries"));
  EXPECT_THAT(complaint(kHeader), testing::HasSubstr("expected a header line and at least one query, got no queries"));
  EXPECT_THAT(complaint("a,b,c\n"), testing::HasSubstr("line 1: expected 32 columns, got 3"));
  std::string header = kHeader;
  header.replace(header.find("toi"), 3, "tio");
  EXPECT_THAT(complaint(header), testing::HasSubstr("expected 'toi' as name of column 6, got 'tio'"));
  EXPECT_THAT(complaint(kHeader + "one,s,s,f,1,0.5,0,1,7," + kCoordinates),
              testing::HasSubstr("line 2: expected 32 columns, got 33"));
  EXPECT_THAT(complaint(kHeader + "one,s,s,f,yes,0.5,0,1," + kCoordinates),
              testing::HasSubstr("expected 0 or 1 in column gt, got 'yes'"));
  EXPECT_THAT(complaint(kHeader + "one,s,s,f,1,1.5,0,1," + kCoordinates),
              testing::HasSubstr("expected a number from 0 to 1 in column toi, got '1.5'"));
  EXPECT_THAT(complaint(kHeader + "one,s,s,f,1,,0,1," + kCoordinates),
              testing::HasSubstr("expected a number from 0 to 1 in column toi, got ''"));
  EXPECT_THAT(complaint(kHeader + "one,s,s,f,0,0.5,0,1," + kCoordinates),
              testing::HasSubstr("expected nothing in column toi where gt is 0"));
  const std::string before = kHeader + "one,s,s,f,1,0.5,0,1," + kCoordinates + "two,s,s,f,1,0.5,0,1,";
  const std::string after = kCoordinates.substr(kCoordinates.find(','));
  for (const char* bad : {"nan", "inf", "0.25x", " 0.25", ""}) {
    EXPECT_THAT(complaint(fmt::format("{}{}{}", before, bad, after)),
                says(fmt::format("line 3: expected a number from ... in column a0x, got '{}'", bad)));
  }
  EXPECT_THROW(readCollisionQueries("no-such-file.csv"), InputError);
}

TEST(QueryFile, JudgesMissesLateTimesAndFalseHits) {
  CollisionQuery query{"one", "some", {true, 0.5}, 0.0, {}};
  query.points[1].start = Vec3(2.0, 0.0, 0.0);
  EXPECT_TRUE(judge(query, {false, 1.0}).missed);
  EXPECT_FALSE(judge(query, {true, 0.5}).late);
  EXPECT_FALSE(judge(query, {true, std::nextafter(0.5, 1.0)}).late);
  EXPECT_TRUE(judge(query, {true, 0.5 + 1e-15}).late);
  query.exact = {false, 1.0};
  query.smallestDistance = kContactError;
  EXPECT_TRUE(judge(query, {true, 0.5}).falseHit);
  EXPECT_FALSE(judge(query, {true, 0.5}).falseBeyondError);
  query.smallestDistance = 3.0 * kContactError;
  EXPECT_TRUE(judge(query, {true, 0.5}).falseBeyondError);
  EXPECT_FALSE(judge(query, {false, 1.0}).falseHit);
}

}  // namespace
}  // namespace springtower
