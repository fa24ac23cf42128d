#pragma once

#include "apps/viewer/input/camera.h"
#include "apps/viewer/input/guide.h"
#include "apps/viewer/session/session.h"

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace springtower {

using Colour = std::array<float, 3>;

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

/// Colours of all blocks under an overlay. Load: newtons that rest on each block; strain: the largest of its springs; hints:
/// green is loose, the drag otherwise.
BlockColours blockColours(const Session& session, Overlay overlay);

/// The colour map of an overlay: from dark blue over green to yellow, of even steps in brightness; for hints from wood to red.
/// `share` 0..1.
Colour colourMap(Overlay overlay, double share);

/// Largest strain of any of a block's springs.
double blockStrain(const BlockModel& model, const ParticleArray& position, std::size_t block);

/// A corner of a triangle to be drawn. A zero normal is drawn in its plain colour, without light.
struct Vertex {
  std::array<float, 3> position;
  std::array<float, 3> normal;
  std::array<float, 2> inFace;  ///< m from the middle of the face
  std::array<float, 2> half;    ///< m, half the sides of the face
  Colour colour;
  std::int32_t block;  ///< or -1
};

/// The triangles of all blocks from their particles' real positions, with the normal of each triangle, so that a bent face shows.
void blockMesh(const ParticleArray& position, std::span<const Colour> colours, std::vector<Vertex>& mesh);

/// Adds a straight line, turned as an arrow is.
void addLine(const Vec3& from, const Vec3& to, const Colour& colour, const Camera& camera, double width_m,
             std::vector<Vertex>& mesh);

/// Adds an arrow that is seen from any side: it turns its width to the camera.
void addArrow(const Vec3& from, const Vec3& to, const Colour& colour, const Camera& camera, double width_m,
              std::vector<Vertex>& mesh);

/// Adds an arrow for each contact: the force on the block above, a centimetre a newton (at least 3 mm); sliding ones in orange.
void addContactArrows(const Session& session, const Camera& camera, std::vector<Vertex>& mesh);

/// The colour that shows how the hand's block touches others.
Colour holdColour(Hold hold);

/// Adds what leads the hand: the line along which it pulls, or the outline of the block where it will lie, blue where it fits and
/// orange where it hangs over.
void addGuide(const Session& session, const Guide& guide, const Hand& hand, const Camera& camera, std::vector<Vertex>& mesh);

/// Adds the hand: an arrow from the block to where the hand moves it, in the colour of its hold.
void addHand(const Session& session, const Hand& hand, const ParticleArray& position, const Camera& camera,
             std::vector<Vertex>& mesh);

}  // namespace springtower
