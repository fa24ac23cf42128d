#include "apps/viewer/view/colours.h"

#include "apps/common/look.h"
#include "broadphase/islands.h"
#include "core/error.h"
#include "core/limits.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <span>

namespace springtower {
namespace {

constexpr Colour kAsleep = {0.35F, 0.42F, 0.55F};
constexpr Colour kAwake = {0.95F, 0.72F, 0.30F};
constexpr Colour kFree = {0.55F, 0.75F, 0.95F};
constexpr Colour kSticks = {0.25F, 0.55F, 1.00F};
constexpr Colour kSlips = {1.00F, 0.50F, 0.10F};
constexpr std::size_t kStrip = 24;  // colours of a map in the legend

constexpr std::array<Colour, 6> kLoadMap = {{{0.16F, 0.12F, 0.40F},
                                             {0.20F, 0.32F, 0.58F},
                                             {0.15F, 0.50F, 0.58F},
                                             {0.22F, 0.66F, 0.47F},
                                             {0.58F, 0.80F, 0.25F},
                                             {0.99F, 0.91F, 0.20F}}};
constexpr std::array<Colour, 6> kStrainMap = {{{0.13F, 0.07F, 0.28F},
                                               {0.36F, 0.11F, 0.43F},
                                               {0.62F, 0.18F, 0.44F},
                                               {0.85F, 0.34F, 0.35F},
                                               {0.97F, 0.58F, 0.28F},
                                               {0.99F, 0.87F, 0.55F}}};
constexpr std::array<Colour, 3> kHeldMap = {{{0.94F, 0.86F, 0.71F}, {0.76F, 0.52F, 0.31F}, {0.36F, 0.17F, 0.11F}}};
constexpr std::array<Colour, 3> kMarginMap = {{{0.95F, 0.45F, 0.05F}, {0.95F, 0.80F, 0.45F}, {0.30F, 0.60F, 0.90F}}};

// Okabe & Ito (2008): seven colours that all eyes tell apart.
constexpr std::array<Colour, 7> kIslands = {{{0.90F, 0.62F, 0.00F},
                                             {0.34F, 0.71F, 0.91F},
                                             {0.00F, 0.62F, 0.45F},
                                             {0.94F, 0.89F, 0.26F},
                                             {0.00F, 0.45F, 0.70F},
                                             {0.84F, 0.37F, 0.00F},
                                             {0.80F, 0.47F, 0.65F}}};

// Between the colours of a map.
Colour onMap(std::span<const Colour> map, double share) {
  const double at = std::clamp(share, 0.0, 1.0) * static_cast<double>(map.size() - 1);
  const std::size_t below = std::min(static_cast<std::size_t>(at), map.size() - 2);
  const auto part = static_cast<float>(at - static_cast<double>(below));
  Colour colour;
  for (std::size_t a = 0; a < 3; ++a) colour[a] = map[below][a] + part * (map[below + 1][a] - map[below][a]);
  return colour;
}

Colour woodOf(std::size_t block) {
  const look::Rgb wood = look::woodOf(static_cast<std::uint32_t>(block));
  return {static_cast<float>(wood[0]), static_cast<float>(wood[1]), static_cast<float>(wood[2])};
}

void byValue(Overlay overlay, const std::vector<double>& values, std::string unit, BlockColours& result) {
  result.most = *std::max_element(values.begin(), values.end());
  result.unit = std::move(unit);
  for (std::size_t b = 0; b < values.size(); ++b) {
    result.colour[b] = colourMap(overlay, result.most > 0.0 ? values[b] / result.most : 0.0);
  }
}

// Islands of awake blocks that touch; sleeping blocks are grey.
void byIsland(const Session& session, BlockColours& result) {
  std::vector<BlockPair> edges;
  for (const ContactForce& contact : session.contacts) {
    if (contact.lower == kFloor) continue;
    const auto a = static_cast<std::int32_t>(contact.upper);
    const auto b = static_cast<std::int32_t>(contact.lower);
    edges.push_back({std::min(a, b), std::max(a, b)});
  }
  std::sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  Islands islands;
  updateIslands(islands, edges, session.simulation.asleep);
  for (std::size_t b = 0; b < result.colour.size(); ++b) {
    const std::int32_t island = islands.islandOf[b];
    result.colour[b] = island < 0 ? kAsleep : kIslands[static_cast<std::size_t>(island) % kIslands.size()];
  }
}

}  // namespace

Overlay overlayFromName(std::string_view name) {
  std::string allowed;
  for (std::size_t i = 0; i < kOverlays; ++i) {
    if (kOverlayNames[i] == name) return static_cast<Overlay>(i);
    allowed += fmt::format("{}{}", i == 0 ? "" : i + 1 == kOverlays ? " or " : ", ", kOverlayNames[i]);
  }
  throw InputError(fmt::format("--overlay: expected {}, got {}", allowed, inQuotes(name)));
}

Colour colourMap(Overlay overlay, double share) {
  switch (overlay) {
    case Overlay::hints:
      return onMap(kHeldMap, share);
    case Overlay::strain:
      return onMap(kStrainMap, share);
    default:
      return onMap(kLoadMap, share);
  }
}

Colour marginColour(double share) {
  return onMap(kMarginMap, share);
}

double blockStrain(const BlockModel& model, const ParticleArray& position, std::size_t block) {
  double most = 0.0;
  for (std::size_t a = 0; a < kCorners; ++a) {
    for (std::size_t b = a + 1; b < kCorners; ++b) {
      const double rest = model.restLength[(a ^ b) - 1][block];
      const double length = (position.at(block, a) - position.at(block, b)).norm();
      most = std::max(most, std::abs(length / rest - 1.0));
    }
  }
  return most;
}

BlockColours blockColours(const Session& session, Overlay overlay) {
  const Simulation& simulation = session.simulation;
  BlockColours result;
  result.colour.resize(simulation.model.blockCount());
  std::vector<double> values(result.colour.size());
  switch (overlay) {
    case Overlay::wood:
      for (std::size_t b = 0; b < values.size(); ++b) result.colour[b] = woodOf(b);
      break;
    case Overlay::load: {
      const std::vector<Hint> all = hints(simulation, session.contacts);
      for (std::size_t b = 0; b < values.size(); ++b) values[b] = all[b].load_n;
      byValue(overlay, values, "N", result);
      break;
    }
    case Overlay::strain:
      for (std::size_t b = 0; b < values.size(); ++b) {
        values[b] = 1e6 * blockStrain(simulation.model, simulation.state.position, b);
      }
      byValue(overlay, values, "\u00b5m/m", result);
      break;
    case Overlay::asleep:
      for (std::size_t b = 0; b < values.size(); ++b) result.colour[b] = simulation.asleep[b] != 0 ? kAsleep : kAwake;
      break;
    case Overlay::islands:
      byIsland(session, result);
      break;
    case Overlay::hints: {
      const std::vector<Hint> all = hints(simulation, session.contacts);
      for (std::size_t b = 0; b < values.size(); ++b) values[b] = all[b].drag_n;
      byValue(overlay, values, "N", result);
      for (std::size_t b = 0; b < values.size(); ++b) {
        if (all[b].loose && mayTake(session.game, blockId(b))) result.colour[b] = kLooseColour;
      }
      break;
    }
  }
  return result;
}

std::vector<LegendRow> legendOf(Overlay overlay, const BlockColours& colours, bool arrows) {
  std::vector<LegendRow> rows;
  std::vector<Colour> strip(kStrip);
  for (std::size_t i = 0; i < kStrip; ++i) strip[i] = colourMap(overlay, static_cast<double>(i) / (kStrip - 1));
  const std::string most = fmt::format("{:.3g} {}", colours.most, colours.unit);
  switch (overlay) {
    case Overlay::wood:
      break;
    case Overlay::load:
      rows.push_back({"Load: 0", strip, most});
      break;
    case Overlay::strain:
      rows.push_back({"Strain: 0", strip, most});
      break;
    case Overlay::asleep:
      rows.push_back({"", {kAwake}, "Awake"});
      rows.push_back({"", {kAsleep}, "Asleep"});
      break;
    case Overlay::islands:
      rows.push_back({"", {kIslands.begin(), kIslands.end()}, "Touching blocks, awake"});
      rows.push_back({"", {kAsleep}, "Asleep"});
      break;
    case Overlay::hints:
      rows.push_back({"", {kLooseColour}, "Loose"});
      rows.push_back({"Held by 0", strip, most});
      break;
  }
  if (!arrows) return rows;
  rows.push_back({"", {kSticks}, "Contact force, 1 cm for 1 N"});
  rows.push_back({"", {kSlips}, "Contact that slides"});
  return rows;
}

Colour holdColour(Hold hold) {
  return hold == Hold::slips ? kSlips : hold == Hold::sticks ? kSticks : kFree;
}

}  // namespace springtower
