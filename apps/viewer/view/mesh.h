#pragma once

#include "apps/viewer/input/camera.h"
#include "apps/viewer/input/guide.h"
#include "apps/viewer/session/session.h"
#include "apps/viewer/view/colours.h"

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace springtower {

/// A corner of a triangle to be drawn. A zero normal is drawn in its plain colour, without light.
struct Vertex {
  std::array<float, 3> position;
  std::array<float, 3> normal;
  std::array<float, 3> local;  ///< m from the block's middle, along its axes
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

/// A margin at which the ring is whole.
inline constexpr double kFullMargin_deg = 15.0;

/// Adds the ring round the foot of a tower (of its poses, what is near the floor) that shows how far it may lean: whole and blue
/// at kFullMargin_deg, the less the more orange, and open towards the side on which it would go over. Without a margin the ring
/// is all open.
void addMargin(const ParticleArray& position, const std::optional<StabilityMargin>& margin, std::vector<Vertex>& mesh);

/// Adds what leads the hand: the line along which it pulls, or the outline of the block where it will lie, blue where it fits and
/// orange where it hangs over.
void addGuide(const Session& session, const Guide& guide, const Hand& hand, const Camera& camera, std::vector<Vertex>& mesh);

/// Adds the hand: an arrow from the block to where the hand moves it, in the colour of its hold.
void addHand(const Session& session, const Hand& hand, const ParticleArray& position, const Camera& camera,
             std::vector<Vertex>& mesh);

}  // namespace springtower
