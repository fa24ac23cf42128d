#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace springtower {

/// The numbers allowed for a value, both ends included; the unit is empty for a pure number.
struct Range {
  double least;
  double most;
  std::string_view unit;
};

// What a scene may hold. The ends are far outside any tower, yet close enough that a double still resolves a millionth of a block
// at the edge of the place range.
inline constexpr Range kDimensionRange{1e-5, 100.0, "m"};
inline constexpr Range kMassRange{1e-9, 1e6, "kg"};
inline constexpr Range kPlaceRange{-1e4, 1e4, "m"};
inline constexpr Range kVelocityRange{-1e3, 1e3, "m/s"};
inline constexpr Range kSpinRange{-1e3, 1e3, "rad/s"};
inline constexpr Range kAmplitudeRange{-100.0, 100.0, "m"};
inline constexpr Range kForceRange{-1e6, 1e6, "N"};
inline constexpr Range kTorqueRange{-1e6, 1e6, "N m"};
inline constexpr Range kTimeRange{0.0, 1e7, "s"};
inline constexpr Range kSecondsRange{1e-3, 1e7, "s"};
inline constexpr Range kFrictionRange{0.0, 10.0, ""};
inline constexpr Range kRestitutionRange{0.0, 1.0, ""};
inline constexpr Range kGravityRange{0.0, 1e3, "m/s2"};
inline constexpr Range kTiltRange{-180.0, 180.0, "deg"};
inline constexpr Range kDirectionRange{-360.0, 360.0, "deg"};
inline constexpr Range kFrequencyRange{0.0, 1e3, "Hz"};
inline constexpr std::size_t kMaxBlocks = 200000;

// What a tower may vary. Three standard deviations, where the variation is cut off, leave half the height and a tenth of the
// mass.
inline constexpr Range kHeightsSigmaRange{0.0, 0.003, "m"};
inline constexpr Range kMassSigmaRange{0.0, 0.0059, "kg"};
inline constexpr Range kPrepareBudgetRange{0.0, 1e7, "s"};
inline constexpr Range kStartGapRange{0.0, 1.0, "m"};
inline constexpr Range kOffsetRange{-1.0, 1.0, "m"};
inline constexpr Range kLooseRange{0.0, 0.009, "m"};
inline constexpr int kMaxRows = 2000;

// What a scripted hand may do.
inline constexpr Range kMoveSpeedRange{1e-3, 2.0, "m/s"};
inline constexpr Range kDropRange{0.0, 1.0, "m"};
inline constexpr Range kHandForceRange{1e-3, 1e3, "N"};
inline constexpr Range kAllowedMoveRange{0.0, 1.0, "m"};

/// Text between single quotes, fit for one line: control characters and bytes beyond ASCII become \xNN, and what follows the
/// first 80 characters becomes "...".
std::string inQuotes(std::string_view text);

/// The text with its control characters as \xNN: names of files, which may hold any, inside a message of one line.
std::string onOneLine(std::string_view text);

/// "0 to 10 m", as messages name a range.
std::string describe(const Range& range);

/// Whether the value is a number inside the range; NaN never is.
constexpr bool isInside(double value, const Range& range) {
  return value >= range.least && value <= range.most;
}

/// Throws InputError "where: expected RANGE, got VALUE" unless the value is a number inside the range.
void requireInRange(double value, const Range& range, std::string_view where);

}  // namespace springtower
