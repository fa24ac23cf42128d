#pragma once

#include "apps/commands/profile/profile.h"

#include <array>
#include <iosfwd>
#include <string_view>

namespace springtower {

/// The frame rate that the 2003 report calls real time, 1/s (its requirement 3.2).
inline constexpr double kReportRate_hz = 12.0;

/// A point of the report's Figure 6.23.
struct RatePoint {
  double rows;
  double framesPerSecond;
};

/// What the report's text says of its Figure 6.23: "a 7 row tower can just be simulated in real-time", which is 12 frames a
/// second. The figure's other points are only in its picture, which the text does not repeat.
inline constexpr std::array<RatePoint, 1> kFigure623 = {{{7.0, kReportRate_hz}}};
inline constexpr std::string_view kFigure623Note =
    "The report's point is from the text under its figure (a 7 row tower can just be simulated in real time, that is at 12 "
    "frames "
    "a second); its other points are in the picture only.";

/// A row of the report's Table 5.2: potential collisions left ("each frame", counted in one step) of towers of 6, 9 and 18 rows
/// (the table says blocks; its first line is 672 n (n - 1) / 2 for n = 3 blocks a row: 336 pairs of features, counted over two
/// passes).
struct CullingRow {
  std::string_view test;
  std::array<double, 3> left;
};
inline constexpr std::array<int, 3> kTable52Rows = {6, 9, 18};
inline constexpr std::array<CullingRow, 5> kTable52 = {{{"no tests", {102816, 235872, 961632}},
                                                        {"boxes of blocks", {30240, 48384, 102816}},
                                                        {"boxes of features", {8274, 13480, 27584}},
                                                        {"plane crossings", {174, 213, 767}},
                                                        {"full tests: collisions", {40, 67, 158}}}};

/// Writes ours beside the report's, as CSV: for each case and test how many pairs of features are left in a step, ours (mean over
/// the steps of the frames that were timed) and, for towers of 6, 9 and 18 rows, the report's, halved because it counts two
/// passes. Ours has one test more: a pair of blocks is looked at only when motion may have used up the gap measured last.
void writeCulling(std::ostream& stream, const Profile& profile);

/// The same as a table for people, of scenes `rest` and `collapse` with 6, 9 and 18 rows; nothing when there are none.
void printCulling(const Profile& profile);

}  // namespace springtower
