#include "core/scene/scene.h"

#include "core/elementary.h"
#include "core/error.h"
#include "core/limits.h"
#include "core/random.h"
#include "core/rotation_vector.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <fmt/format.h>
#include <limits>
#include <numbers>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

namespace springtower {
namespace {

constexpr int kPositions = 3;
constexpr double kLooseBy_m = 0.0003;
constexpr double kMaxDeviations = 3.0;
// Distance of the centres of two neighbours in a row: three blocks then span exactly a block's length.
constexpr double kPitch_m = (kBlockLength_m - kBlockWidth_m) / 2.0;

struct Place {
  bool present = false;
  double lowerBy_m = 0.0;
  Vec3 offset = Vec3::Zero();
};
using Row = std::array<Place, kPositions>;

// Reads a bit code from left to right; each complaint names the character it stopped at.
class BitCodeReader {
 public:
  explicit BitCodeReader(std::string_view code) : code_(code) {}

  std::vector<Row> rows() {
    std::vector<Row> rows;
    expect('(');
    for (;;) {
      const std::size_t start = next_;
      rows.push_back(row());
      expect(')');
      if (std::none_of(rows.back().begin(), rows.back().end(), [](const Place& place) { return place.present; })) {
        next_ = start;
        fail("a row without blocks", "at least one block in every row");
      }
      if (next_ == code_.size()) return rows;
      if (rows.size() == static_cast<std::size_t>(kMaxRows)) fail("more", fmt::format("1 to {} rows", kMaxRows));
      if (code_[next_] != '-') fail(found(), "- or the end");
      ++next_;
      expect('(');
    }
  }

 private:
  Row row() {
    Row row;
    for (Place& place : row) {
      const char mark = next_ < code_.size() ? code_[next_] : '\0';
      if (mark != '0' && mark != '1' && mark != 'L') fail(found(), "0, 1 or L");
      place.present = mark != '0';
      place.lowerBy_m = mark == 'L' ? kLooseBy_m : 0.0;
      ++next_;
    }
    return row;
  }

  void expect(char wanted) {
    if (next_ >= code_.size() || code_[next_] != wanted) fail(found(), std::string(1, wanted));
    ++next_;
  }

  [[nodiscard]] std::string found() const { return next_ < code_.size() ? inQuotes(code_.substr(next_, 1)) : "the end"; }

  [[noreturn]] void fail(std::string_view found, std::string_view allowed) const {
    throw InputError(fmt::format("bit code {}: character {}: expected {}, got {}", inQuotes(code_), next_ + 1, allowed, found));
  }

  std::string_view code_;
  std::size_t next_ = 0;
};

// The place of a block that an offset or a loose block names.
Place& presentPlace(std::vector<Row>& rows, int row, int position, std::string_view what) {
  const bool inside = row >= 0 && static_cast<std::size_t>(row) < rows.size() && position >= 1 && position <= kPositions;
  if (inside) {
    Place& place = rows[static_cast<std::size_t>(row)][static_cast<std::size_t>(position) - 1];
    if (place.present) return place;
  }
  throw InputError(fmt::format("{}: expected rows 0 to {} and positions 1 to 3 where a block is present, got no block there",
                               what, rows.size() - 1));
}

void requireFirstNaming(std::vector<std::array<int, 2>>& named, std::array<int, 2> place, std::string_view what) {
  if (std::find(named.begin(), named.end(), place) != named.end()) {
    throw InputError(fmt::format("{}: expected once, got it twice", what));
  }
  named.push_back(place);
}

void applyOffsets(std::vector<Row>& rows, const TowerOptions& options, std::string_view name) {
  std::vector<std::array<int, 2>> named;
  for (const BlockOffset& offset : options.offsets) {
    const std::string what = fmt::format("{}: offset of row {}, position {}", name, offset.row, offset.position);
    Place& place = presentPlace(rows, offset.row, offset.position, what);
    requireFirstNaming(named, {offset.row, offset.position}, what);
    requireInRange(offset.dx, kOffsetRange, what + ": dx");
    requireInRange(offset.dy, kOffsetRange, what + ": dy");
    place.offset = {offset.dx, offset.dy, 0.0};
  }
}

void applyLoose(std::vector<Row>& rows, const TowerOptions& options, std::string_view name) {
  std::vector<std::array<int, 2>> named;
  for (const LooseBlock& loose : options.loose) {
    const std::string what = fmt::format("{}: loose block at row {}, position {}", name, loose.row, loose.position);
    Place& place = presentPlace(rows, loose.row, loose.position, what);
    requireFirstNaming(named, {loose.row, loose.position}, what);
    requireInRange(loose.by, kLooseRange, what + ": lower by");
    place.lowerBy_m = loose.by;
  }
}

double variation(RandomStream& random, double sigma) {
  return sigma * std::clamp(random.normal(), -kMaxDeviations, kMaxDeviations);
}

Scene sceneOfRows(std::vector<Row> rows, const TowerOptions& options, std::string_view name) {
  const double heightsSigma = options.heightsSigma_m.value_or(0.0);
  const double massSigma = options.massSigma_kg.value_or(0.0);
  const double startGap = options.startGap_m.value_or(0.0);
  const std::string source = name.size() <= 80 ? std::string(name) : std::string(name.substr(0, 80)) + "...";
  requireInRange(heightsSigma, kHeightsSigmaRange, source + ": standard deviation of the heights");
  requireInRange(massSigma, kMassSigmaRange, source + ": standard deviation of the masses");
  requireInRange(startGap, kStartGapRange, source + ": start gap");
  applyOffsets(rows, options, source);
  applyLoose(rows, options, source);

  Scene scene;
  scene.name = name;
  RandomStream heights(options.seed.value_or(1), 0);
  RandomStream masses(options.seed.value_or(1), 1);
  const Eigen::Quaterniond quarterTurn = rotationAbout(Vec3::UnitZ(), 0.5 * std::numbers::pi);
  double bottom = 0.0;
  for (std::size_t r = 0; r < rows.size(); ++r) {
    double top = 0.0;
    for (std::size_t p = 0; p < kPositions; ++p) {
      // Absent places draw as well, so that taking out a block changes no other.
      const double heightVariation = variation(heights, heightsSigma);
      const double massVariation = variation(masses, massSigma);
      const Place& place = rows[r][p];
      if (!place.present) continue;
      BlockSpec block;
      block.dimensions.z() = kBlockHeight_m + heightVariation - place.lowerBy_m;
      block.mass = kBlockMass_kg + massVariation;
      block.row = static_cast<int>(r);
      block.position = static_cast<int>(p) + 1;
      const double across = kPitch_m * (static_cast<double>(p) - 1.0);
      const bool alongX = r % 2 == 0;
      if (!alongX) block.orientation = quarterTurn;
      // Written as a block's corners are computed, so that faces that touch are equal to the last bit or nearly so.
      block.centre = Vec3(alongX ? 0.0 : across, alongX ? across : 0.0, bottom + 0.5 * block.dimensions.z()) + place.offset;
      top = std::max(top, block.centre.z() + 0.5 * block.dimensions.z());
      scene.blocks.push_back(block);
    }
    bottom = top + startGap;
  }
  checkScene(scene, source);
  return scene;
}

}  // namespace

Vec3 Gravity::at(double time_s) const {
  constexpr double kRadians = std::numbers::pi / 180.0;
  const double lean = kRadians * (tilt_deg + sway_deg * elementary::sin(2.0 * std::numbers::pi * sway_hz * time_s));
  const double direction = kRadians * direction_deg;
  return magnitude * Vec3(elementary::sin(lean) * elementary::cos(direction), elementary::sin(lean) * elementary::sin(direction),
                          -elementary::cos(lean));
}

double blockHeightOf(const Scene& scene) {
  double least = std::numeric_limits<double>::max();
  for (const BlockSpec& block : scene.blocks) least = std::min(least, block.dimensions.minCoeff());
  return least;
}

double toleranceOf(const Scene& scene) {
  if (scene.settings.tolerance_m) return *scene.settings.tolerance_m;
  return kBlockTolerance_m * (blockHeightOf(scene) / kBlockHeight_m);
}

std::string_view firstGiven(const TowerOptions& options) {
  const std::pair<bool, std::string_view> all[] = {{options.heightsSigma_m.has_value(), "a variation of heights"},
                                                   {options.massSigma_kg.has_value(), "a variation of masses"},
                                                   {options.seed.has_value(), "a seed"},
                                                   {options.startGap_m.has_value(), "a start gap"},
                                                   {!options.offsets.empty(), "offsets"},
                                                   {!options.loose.empty(), "loose blocks"}};
  for (const auto& [isGiven, name] : all) {
    if (isGiven) return name;
  }
  return {};
}

Scene towerScene(int rows, const TowerOptions& options) {
  const std::string name = fmt::format("tower:{}", rows);
  if (rows < 1 || rows > kMaxRows) {
    throw InputError(fmt::format("{}: expected 1 to {} rows, got {}", name, kMaxRows, rows));
  }
  Row full;
  full.fill({.present = true});
  return sceneOfRows(std::vector<Row>(static_cast<std::size_t>(rows), full), options, name);
}

Scene bitCodeScene(std::string_view code, const TowerOptions& options) {
  return sceneOfRows(BitCodeReader(code).rows(), options, code);
}

Scene sceneFromName(const std::string& name, const TowerOptions& options) {
  constexpr std::string_view kTower = "tower:";
  if (name.starts_with(kTower)) {
    int rows = 0;
    const char* const end = name.data() + name.size();
    const auto [stop, error] = std::from_chars(name.data() + kTower.size(), end, rows);
    if (error != std::errc{} || stop != end) {
      throw InputError(fmt::format("tower:R: expected a whole number of rows from 1 to {}, got {}", kMaxRows,
                                   inQuotes(std::string_view(name).substr(kTower.size()))));
    }
    return towerScene(rows, options);
  }
  return name.starts_with('(') ? bitCodeScene(name, options) : sceneFromToml(name, options);
}

}  // namespace springtower
