#pragma once

#include "apps/viewer/session/session.h"

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace springtower {

// What the colours of the picture mean. Neighbours differ in brightness or as blue and yellow do, not as red and green alone, so
// that colour-blind eyes read them too.

using Colour = std::array<float, 3>;

/// Loose blocks under the hints.
inline constexpr Colour kLooseColour = {0.16F, 0.47F, 0.86F};

/// What the colours of the blocks show.
enum class Overlay : std::size_t { wood, load, strain, asleep, islands, hints };
inline constexpr std::size_t kOverlays = 6;
inline constexpr std::array<std::string_view, kOverlays> kOverlayNames = {"wood", "load", "strain", "asleep", "islands", "hints"};

/// The overlay of a name. Throws InputError naming what is allowed.
Overlay overlayFromName(std::string_view name);

/// A colour of each block and what they mean.
struct BlockColours {
  std::vector<Colour> colour;  ///< [blocks]
  double most = 0.0;           ///< the value of the colour map's upper end, 0 without a map
  std::string unit;            ///< of the map's values
};

/// Colours of all blocks under an overlay. Load: newtons that rest on each block; strain: the largest of its springs; hints: blue
/// is loose, the drag otherwise.
BlockColours blockColours(const Session& session, Overlay overlay);

/// The colour map of an overlay, of even steps in brightness: load from dark blue over green to yellow, strain from violet over
/// red to yellow, hints from light to dark wood. `share` 0..1.
Colour colourMap(Overlay overlay, double share);

/// How far the tower may lean, from hardly to far: orange to blue. `share` 0..1.
Colour marginColour(double share);

/// One line of the legend: words, a strip of colours, and words again.
struct LegendRow {
  std::string before;
  std::vector<Colour> colours;
  std::string after;
};

/// What the colours of the blocks, and of arrows of contact forces where they are shown, mean.
std::vector<LegendRow> legendOf(Overlay overlay, const BlockColours& colours, bool arrows);

/// Largest strain of any of a block's springs.
double blockStrain(const BlockModel& model, const ParticleArray& position, std::size_t block);

/// The colour that shows how the hand's block touches others.
Colour holdColour(Hold hold);

}  // namespace springtower
