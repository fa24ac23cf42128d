#include "apps/commands/profile/report_figures.h"

#include <algorithm>
#include <fmt/format.h>
#include <ostream>

namespace springtower {
namespace {

constexpr double kFeaturePairs = 336.0;  // of two blocks: 192 of a corner and a triangle, 144 of two edges
constexpr double kReportPasses = 2.0;

// A test, which row of the report's table is its like (-1: none), and what it leaves of a step in ours.
struct OurRow {
  std::string_view test;
  int reported;
  double left;
};

std::array<OurRow, 6> cullingOf(const ProfileResult& result) {
  const auto blocks = static_cast<double>(result.blocks);
  const double steps = std::max(1.0, counted(result, "steps"));
  return {{{"no tests", 0, 0.5 * blocks * (blocks - 1.0) * kFeaturePairs},
           {"boxes of blocks", 1, counted(result, "block_pairs") * kFeaturePairs},
           {"gap used up", -1, counted(result, "candidate_tests") / steps},
           {"boxes of features", 2, counted(result, "box_overlaps") / steps},
           {"plane crossings", 3, counted(result, "plane_crossings") / steps},
           {"collisions", 4, counted(result, "cubic_hits") / steps}}};
}

// The report's figure of one pass, empty where it has none.
std::string reportedFor(int row, int rows) {
  const auto* const column = std::find(kTable52Rows.begin(), kTable52Rows.end(), rows);
  if (row < 0 || column == kTable52Rows.end()) return "";
  const auto at = static_cast<std::size_t>(column - kTable52Rows.begin());
  return fmt::format("{}", kTable52[static_cast<std::size_t>(row)].left[at] / kReportPasses);
}

bool isListed(const ProfileResult& result) {
  return result.failure.empty() && (result.what.scene == ProfileScene::rest || result.what.scene == ProfileScene::collapse) &&
         std::find(kTable52Rows.begin(), kTable52Rows.end(), result.what.rows) != kTable52Rows.end();
}

}  // namespace

void writeCulling(std::ostream& stream, const Profile& profile) {
  const Provenance& from = profile.provenance;
  stream << "scene,rows,blocks,method,tolerance_m,threads,steps_per_frame,test,left_per_step,report_table_5_2_per_pass,commit,"
            "compiler,flags,cpu,date\n";
  for (const ProfileResult& result : profile.results) {
    if (!result.failure.empty()) continue;
    for (const OurRow& row : cullingOf(result)) {
      stream << fmt::format("{},{},{},{},{},{},{},{},{},{},{},\"{}\",\"{}\",\"{}\",{}\n", nameOf(result.what.scene),
                            result.what.rows, result.blocks, result.methodName, result.what.tolerance_m, result.what.threads,
                            counted(result, "steps"), row.test, row.left,
                            reportedFor(row.reported, result.what.towers == 1 ? result.what.rows : 0), from.commit, from.compiler,
                            from.flags, from.processor, from.date);
    }
  }
}

void printCulling(const Profile& profile) {
  if (std::none_of(profile.results.begin(), profile.results.end(), isListed)) return;
  fmt::print("\npairs of features left in a step after each test, and the report's Table 5.2 (halved: it counts two passes)\n");
  fmt::print("{:<11}{:>7} {:<22}", "scene", "rows", "method");
  for (const OurRow& row : cullingOf(profile.results.front())) fmt::print("{:>19}", row.test);
  fmt::print("\n");
  for (const int rows : kTable52Rows) {
    bool any = false;
    for (const ProfileResult& result : profile.results) {
      if (!isListed(result) || result.what.rows != rows || result.what.threads != profile.results.front().what.threads) continue;
      any = true;
      fmt::print("{:<11}{:>7} {:<22}", nameOf(result.what.scene), rows, result.methodName);
      for (const OurRow& row : cullingOf(result)) fmt::print("{:>19.6g}", row.left);
      fmt::print("\n");
    }
    if (!any) continue;
    fmt::print("{:<11}{:>7} {:<22}", "Table 5.2", rows, "the report, 2003");
    for (const OurRow& row : cullingOf(profile.results.front())) fmt::print("{:>19}", reportedFor(row.reported, rows));
    fmt::print("\n");
  }
}

}  // namespace springtower
