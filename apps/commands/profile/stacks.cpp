#include "apps/commands/profile/stacks.h"

#include "apps/common/options.h"
#include "core/elementary.h"
#include "core/error.h"
#include "core/limits.h"
#include "scenarios/towers.h"
#include "scenarios/walls.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fmt/format.h>
#include <limits>
#include <numbers>
#include <utility>

namespace springtower {
namespace {

constexpr double kNotSet = std::numeric_limits<double>::quiet_NaN();

constexpr int kMaxStartRows = 1000;
constexpr int kManyRows = 18;

Scene unevenTower(int rows) {
  return towerScene(rows, {.heightsSigma_m = kUnevenHeightsSigma_m});
}

// Leaning by a share of the slope at which it tips over or slides, whichever comes first.
Scene tilted(Scene tower, int rows) {
  const double tipping = elementary::atan2(kBlockLength_m, static_cast<double>(rows) * kBlockHeight_m);
  const double sliding = elementary::atan2(tower.staticFriction, 1.0);
  return leaning(std::move(tower), kStartTiltShare * std::min(tipping, sliding) * 180.0 / std::numbers::pi);
}

constexpr std::array<StackFamily, kStackFamilies> kFamilies = {
    {{"wall",
      "wall:COLUMNSxCOURSES",
      "walls in running bond",
      ProfileScene::walls,
      {4000, 100},
      [](int columns, int courses) { return wallScene(columns, courses); }},
     {"cubes",
      "cubes:ROWS",
      "pyramids of cubes",
      ProfileScene::pyramids,
      {400, 0},
      [](int rows, int) { return cubePyramidScene(rows); }},
     {"bricks",
      "bricks:ROWS",
      "pyramids of bricks",
      ProfileScene::pyramids,
      {400, 0},
      [](int rows, int) { return brickPyramidScene(rows); }},
     {"tower", "tower:ROWS", "towers", ProfileScene::starts, {kMaxStartRows, 0}, [](int rows, int) { return towerScene(rows); }},
     {"uneven",
      "uneven:ROWS",
      "towers of uneven heights",
      ProfileScene::starts,
      {kMaxStartRows, 0},
      [](int rows, int) { return unevenTower(rows); }},
     {"tilted",
      "tilted:ROWS",
      "towers under tilted gravity",
      ProfileScene::starts,
      {kMaxStartRows, 0},
      [](int rows, int) { return tilted(towerScene(rows), rows); }},
     {"uneven-tilted",
      "uneven-tilted:ROWS",
      "uneven towers under tilted gravity",
      ProfileScene::starts,
      {kMaxStartRows, 0},
      [](int rows, int) { return tilted(unevenTower(rows), rows); }},
     {"tilted-towers",
      "tilted-towers:TOWERS",
      "many towers under tilted gravity",
      ProfileScene::starts,
      {2000, 0},
      [](int towers, int) { return squareOf(tilted(towerScene(kManyRows), kManyRows), towers); }}}};

constexpr auto kGoals = std::to_array<StackGoal>({{"wall:20x12", {0.4, kNotSet}, {0.3, kNotSet}, kNotSet},
                                                  {"wall:40x25", {3.0, kNotSet}, {2.0, kNotSet}, 0.12},
                                                  {"wall:200x25", {17.0, 11.0}, {12.0, 7.0}, 0.8},
                                                  {"bricks:40", {3.5, kNotSet}, {2.5, kNotSet}, kNotSet},
                                                  {"bricks:60", {kNotSet, kNotSet}, {kNotSet, kNotSet}, 1.0},
                                                  {"cubes:40", {4.0, kNotSet}, {1.5, kNotSet}, kNotSet},
                                                  {"cubes:100", {16.0, 10.0}, {9.0, 5.0}, 6.0},
                                                  {"tower:18", {kNotSet, kNotSet}, {kNotSet, kNotSet}, 0.005},
                                                  {"uneven:18", {kNotSet, kNotSet}, {kNotSet, kNotSet}, 0.025},
                                                  {"tilted:18", {kNotSet, kNotSet}, {kNotSet, kNotSet}, 0.025},
                                                  {"uneven-tilted:18", {kNotSet, kNotSet}, {kNotSet, kNotSet}, 0.05},
                                                  {"tilted:144", {kNotSet, kNotSet}, {kNotSet, kNotSet}, 1.0},
                                                  {"tilted-towers:64", {kNotSet, kNotSet}, {kNotSet, kNotSet}, 1.0}});

// The size after the colon: as many whole numbers as the family has, with an x between, each within its range.
std::optional<std::array<int, 2>> sizeOf(const StackFamily& family, std::string_view stack) {
  std::array<int, 2> size{};
  std::string_view text = stack.substr(std::min(stack.size(), family.name.size()));
  for (std::size_t i = 0; i < 2 && family.most[i] > 0; ++i) {
    if (!text.starts_with(i == 0 ? ':' : 'x')) return {};
    text.remove_prefix(1);
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), size[i]);
    if (error != std::errc{} || size[i] < 1 || size[i] > family.most[i]) return {};
    text.remove_prefix(static_cast<std::size_t>(end - text.data()));
  }
  return text.empty() ? std::optional(size) : std::nullopt;
}

std::string_view nameIn(std::string_view stack) {
  return stack.substr(0, stack.find(':'));
}

std::string offered() {
  std::string text;
  for (const StackFamily& family : kFamilies) {
    text += fmt::format("{}{} of 1 to {}", text.empty() ? "" : ", ", family.usage, family.most[0]);
    if (family.most[1] > 0) text += fmt::format(" and 1 to {}", family.most[1]);
  }
  return text;
}

}  // namespace

std::span<const StackFamily> stackFamilies() {
  return kFamilies;
}

const StackFamily& familyOf(std::string_view stack) {
  return *std::find_if(kFamilies.begin(), kFamilies.end(),
                       [&](const StackFamily& family) { return family.name == nameIn(stack); });
}

std::span<const StackGoal> stackGoals() {
  return kGoals;
}

std::vector<std::string> stacksOf(ProfileScene scene, ProfileExtent choice) {
  if (scene == ProfileScene::starts) {
    std::vector<std::string> starts = {"tower:18", "uneven:18", "tilted:18", "uneven-tilted:18"};
    if (choice != ProfileExtent::quick) starts.insert(starts.end(), {"tilted:144", "tilted-towers:64"});
    return starts;
  }
  const bool walls = scene == ProfileScene::walls;
  if (choice == ProfileExtent::quick) {
    if (walls) return {"wall:20x12", "wall:28x18"};
    return {"cubes:22", "cubes:28", "bricks:22", "bricks:28"};
  }
  std::vector<std::string> stacks = {"wall:20x12", "wall:40x25", "wall:80x25", "wall:200x25"};
  if (!walls) stacks = {"cubes:22", "cubes:40", "cubes:100", "bricks:22", "bricks:40", "bricks:60"};
  if (choice == ProfileExtent::full) stacks.emplace_back(walls ? "wall:4000x25" : "bricks:100");
  return stacks;
}

std::string stackFrom(const std::string& text) {
  const auto* const family =
      std::find_if(kFamilies.begin(), kFamilies.end(), [&](const StackFamily& one) { return one.name == nameIn(text); });
  if (family == kFamilies.end() || !sizeOf(*family, text))
    throw InputError(fmt::format("--stacks: expected {}, got {}", offered(), inQuotes(text)));
  return text;
}

Scene stackScene(const std::string& stack) {
  const StackFamily& family = familyOf(stack);
  const std::array<int, 2> size = *sizeOf(family, stack);
  Scene scene = family.make(size[0], size[1]);
  scene.name = stack;
  return scene;
}

std::optional<double> growthExponent(std::span<const double> blocks, std::span<const double> ms) {
  const auto count = static_cast<double>(blocks.size());
  double meanX = 0.0;
  double meanY = 0.0;
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    meanX += std::log(blocks[i]) / count;
    meanY += std::log(ms[i]) / count;
  }
  double squares = 0.0;
  double products = 0.0;
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    const double x = std::log(blocks[i]) - meanX;
    squares += x * x;
    products += x * (std::log(ms[i]) - meanY);
  }
  constexpr double kOneSize = 1e-12;
  return squares > kOneSize ? std::optional(products / squares) : std::nullopt;
}

std::vector<StackGrowth> stackGrowth(const Profile& profile) {
  std::vector<StackGrowth> growth;
  std::vector<int> threads;
  for (const ProfileResult& result : profile.results) {
    if (std::find(threads.begin(), threads.end(), result.what.threads) == threads.end()) threads.push_back(result.what.threads);
  }
  for (const StackFamily& family : kFamilies) {
    for (const int count : threads) {
      std::vector<double> blocks;
      std::vector<double> ms;
      for (const ProfileResult& result : profile.results) {
        const bool counts = isStack(result.what.scene) && nameIn(result.what.named) == family.name &&
                            result.what.threads == count && result.failure.empty() && result.blocks >= kGrowthLeastBlocks &&
                            result.what.method == Settings{}.method;
        if (!counts) continue;
        blocks.push_back(static_cast<double>(result.blocks));
        ms.push_back(result.cost().median);
      }
      const std::optional<double> exponent = growthExponent(blocks, ms);
      if (!exponent) continue;
      const auto [least, most] = std::minmax_element(blocks.begin(), blocks.end());
      growth.push_back({family.name, count, static_cast<std::size_t>(*least), static_cast<std::size_t>(*most), *exponent});
    }
  }
  return growth;
}

const PeerFigures* nearestInAccuracy(const ProfileResult& result) {
  // A depth below this is no better, mm; without it a stack that is not deep at all would be infinitely far from any.
  constexpr double kNoDepth_mm = 1e-6;
  const auto farFrom = [&](const PeerFigures& peer) {
    return std::abs(std::log(std::max(peer.penetration_mm, kNoDepth_mm) / std::max(result.penetration_mm, kNoDepth_mm)));
  };
  const PeerFigures* nearest = nullptr;
  for (const PeerFigures& peer : result.peers) {
    const bool better = nearest == nullptr || (peer.stands && !nearest->stands) ||
                        (peer.stands == nearest->stands && farFrom(peer) < farFrom(*nearest));
    if (better) nearest = &peer;
  }
  return nearest;
}

}  // namespace springtower
