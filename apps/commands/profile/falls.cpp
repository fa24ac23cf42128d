#include "apps/commands/profile/falls.h"

#include "apps/common/options.h"
#include "core/error.h"
#include "core/limits.h"
#include "scenarios/falling.h"
#include "scenarios/towers.h"
#include "scenarios/walls.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <fmt/format.h>

namespace springtower {
namespace {

constexpr int kFallTowerRows = 18;

constexpr auto kFallFamilies = std::to_array<FallFamily>({
    {"topple", "topple:ROWS", "towers that topple", ProfileScene::topple, kMaxRows, 300,
     [](int rows) { return leaning(towerScene(rows), kTopplingTilt_deg); }},
    {"towers", "towers:TOWERS", "many towers that topple", ProfileScene::topple, 1000, 180,
     [](int towers) { return leaning(squareOf(towerScene(kFallTowerRows), towers), kTopplingTilt_deg); }},
    {"shot", "shot:ROWS", "towers that are hit", ProfileScene::hit, kMaxRows, 180, shotTowerScene},
    {"heap", "heap:BLOCKS", "heaps", ProfileScene::heaps, 20000, 180, heapScene},
    {"pile", "pile:ROWS", "piles", ProfileScene::piles, 100, 60,
     [](int rows) { return pileScene(rows, {.fall_m = kPileFall_m}); }},
    {"rain", "rain:BLOCKS", "rain", ProfileScene::rain, 20000, 180, rainScene},
});

constexpr auto kFallGoals = std::to_array<FallGoal>({{"topple:18", 1.15, 2.4, 0.8, 1.6},
                                                     {"topple:144", 10.0, 25.0, 6.0, 20.0},
                                                     {"towers:64", 110.0, 208.0, 50.0, 110.0},
                                                     {"shot:18", 1.3, 2.9, 0.8, 2.0, 0.5},
                                                     {"heap:200", 3.9, 9.0, 2.5, 6.0},
                                                     {"heap:1000", 31.0, 72.0, 15.0, 35.0},
                                                     {"pile:9", 39.0, 83.0, 15.0, 40.0},
                                                     {"pile:46", 364.0, 675.0, 120.0, 300.0},
                                                     {"rain:200", 3.5, 8.2, 2.5, 6.0},
                                                     {"rain:1000", 22.0, 50.0, 15.0, 40.0}});

std::optional<int> fallSizeOf(const FallFamily& family, std::string_view fall) {
  std::string_view text = fall.substr(std::min(fall.size(), family.name.size()));
  if (!text.starts_with(':')) return {};
  text.remove_prefix(1);
  int size = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), size);
  if (error != std::errc{} || end != text.data() + text.size() || size < 1 || size > family.most) return {};
  return size;
}

std::string_view familyNameIn(std::string_view fall) {
  return fall.substr(0, fall.find(':'));
}

std::string offeredFalls() {
  std::string text;
  for (const FallFamily& family : kFallFamilies)
    text += fmt::format("{}{} of 1 to {}", text.empty() ? "" : ", ", family.usage, family.most);
  return text;
}

}  // namespace

std::span<const FallFamily> fallFamilies() {
  return kFallFamilies;
}

const FallFamily& fallFamilyOf(std::string_view fall) {
  return *std::find_if(kFallFamilies.begin(), kFallFamilies.end(),
                       [&](const FallFamily& family) { return family.name == familyNameIn(fall); });
}

std::span<const FallGoal> fallGoals() {
  return kFallGoals;
}

std::vector<std::string> fallsOf(ProfileScene scene, ProfileExtent extent) {
  const bool quick = extent == ProfileExtent::quick;
  const bool full = extent == ProfileExtent::full;
  std::vector<std::string> falls;
  if (scene == ProfileScene::topple) {
    falls = {"topple:18"};
    if (!quick) falls.insert(falls.end(), {"topple:144", "towers:64"});
  } else if (scene == ProfileScene::hit) {
    falls = {"shot:18"};
  } else if (scene == ProfileScene::piles) {
    falls = {quick ? "pile:1" : "pile:9"};
    if (full) falls.emplace_back("pile:46");
  } else {
    const std::string_view name = scene == ProfileScene::heaps ? "heap" : "rain";
    falls = {fmt::format("{}:{}", name, quick ? 50 : 200)};
    if (!quick) falls.push_back(fmt::format("{}:1000", name));
  }
  return falls;
}

std::string fallFrom(const std::string& text) {
  const auto found = std::find_if(kFallFamilies.begin(), kFallFamilies.end(),
                                  [&](const FallFamily& family) { return family.name == familyNameIn(text); });
  if (found == kFallFamilies.end() || !fallSizeOf(*found, text))
    throw InputError(fmt::format("--falls: expected {}, got {}", offeredFalls(), inQuotes(text)));
  return text;
}

Scene fallScene(const std::string& fall) {
  const FallFamily& family = fallFamilyOf(fall);
  Scene scene = family.make(*fallSizeOf(family, fall));
  scene.name = fall;
  return scene;
}

}  // namespace springtower
