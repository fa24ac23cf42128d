#include "apps/viewer/view/overlays.h"

#include "broadphase/islands.h"
#include "core/error.h"
#include "core/limits.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace springtower {
namespace {

constexpr Colour kWood = {0.80F, 0.62F, 0.40F};
constexpr Colour kAsleep = {0.35F, 0.42F, 0.55F};
constexpr Colour kAwake = {0.95F, 0.72F, 0.30F};
constexpr Colour kLoose = {0.30F, 0.80F, 0.35F};
constexpr Colour kFree = {0.55F, 0.75F, 0.95F};
constexpr Colour kSticks = {0.25F, 0.55F, 1.00F};
constexpr Colour kSlips = {1.00F, 0.50F, 0.10F};
constexpr double kMinForce_n = 1e-3;
constexpr double kMetresPerNewton = 0.01;
constexpr double kShortestArrow_m = 0.003;
constexpr double kLineInLengths = 1.5;  // of the line along which a block is pulled

// Even steps in brightness and hue, from dark to bright.
constexpr std::array<Colour, 6> kMap = {{{0.16F, 0.12F, 0.40F},
                                         {0.20F, 0.32F, 0.58F},
                                         {0.15F, 0.50F, 0.58F},
                                         {0.22F, 0.66F, 0.47F},
                                         {0.58F, 0.80F, 0.25F},
                                         {0.99F, 0.91F, 0.20F}}};

// From hardly held to held fast.
constexpr std::array<Colour, 3> kHeldMap = {{{0.88F, 0.78F, 0.62F}, {0.82F, 0.50F, 0.30F}, {0.58F, 0.14F, 0.12F}}};

// Each block's own shade, in steps of the golden section so that neighbours differ.
Colour woodOf(std::size_t block) {
  const auto bright = static_cast<float>(std::fmod(0.618033988749895 * static_cast<double>(block), 1.0) - 0.5);
  const auto warm = static_cast<float>(std::fmod(0.754877666246693 * static_cast<double>(block), 1.0) - 0.5);
  return {kWood[0] * (1.0F + 0.14F * bright + 0.04F * warm), kWood[1] * (1.0F + 0.14F * bright),
          kWood[2] * (1.0F + 0.14F * bright - 0.10F * warm)};
}

void byValue(Overlay overlay, const std::vector<double>& values, std::string unit, BlockColours& result) {
  result.most = *std::max_element(values.begin(), values.end());
  result.unit = std::move(unit);
  for (std::size_t b = 0; b < values.size(); ++b) {
    result.colour[b] = colourMap(overlay, result.most > 0.0 ? values[b] / result.most : 0.0);
  }
}

// Islands of awake blocks that touch, in hues as far apart as may be; sleeping blocks are grey.
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
  constexpr double kGolden = 0.618033988749895;
  for (std::size_t b = 0; b < result.colour.size(); ++b) {
    const std::int32_t island = islands.islandOf[b];
    if (island < 0) {
      result.colour[b] = kAsleep;
      continue;
    }
    const double hue = 6.0 * std::fmod(kGolden * island + 0.08, 1.0);
    for (std::size_t a = 0; a < 3; ++a) {
      const double k = std::fmod(5.0 - 2.0 * static_cast<double>(a) + hue, 6.0);
      result.colour[b][a] = static_cast<float>(0.9 - 0.55 * std::clamp(std::min(k, 4.0 - k), 0.0, 1.0));
    }
  }
}

void addTriangle(const Vec3& a, const Vec3& b, const Vec3& c, const Colour& colour, std::vector<Vertex>& mesh) {
  for (const Vec3* corner : {&a, &b, &c}) {
    Vertex vertex{};
    for (std::size_t i = 0; i < 3; ++i) vertex.position[i] = static_cast<float>((*corner)[static_cast<Eigen::Index>(i)]);
    vertex.colour = colour;
    vertex.block = -1;
    mesh.push_back(vertex);
  }
}

}  // namespace

Overlay overlayFromName(std::string_view name) {
  std::string allowed;
  for (std::size_t i = 0; i < kOverlays; ++i) {
    if (kOverlayNames[i] == name) return static_cast<Overlay>(i);
    allowed += fmt::format("{}{}", i == 0 ? "" : i + 1 == kOverlays ? " or " : ", ", kOverlayNames[i]);
  }
  throw InputError(fmt::format("--overlay: found {}, allowed {}", inQuotes(name), allowed));
}

Colour colourMap(Overlay overlay, double share) {
  const std::span<const Colour> map = overlay == Overlay::hints ? std::span<const Colour>(kHeldMap) : kMap;
  const double at = std::clamp(share, 0.0, 1.0) * static_cast<double>(map.size() - 1);
  const std::size_t below = std::min(static_cast<std::size_t>(at), map.size() - 2);
  const auto part = static_cast<float>(at - static_cast<double>(below));
  Colour colour;
  for (std::size_t a = 0; a < 3; ++a) colour[a] = map[below][a] + part * (map[below + 1][a] - map[below][a]);
  return colour;
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
  result.colour.assign(simulation.model.blockCount(), kWood);
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
      byValue(overlay, values, "um/m", result);
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
        if (all[b].loose && mayTake(session.game, blockId(b))) result.colour[b] = kLoose;
      }
      break;
    }
  }
  return result;
}

void blockMesh(const ParticleArray& position, std::span<const Colour> colours, std::vector<Vertex>& mesh) {
  for (std::size_t b = 0; b < position.blockCount(); ++b) {
    for (std::size_t t = 0; t < kTriangles; ++t) {
      std::array<Vec3, 3> corner;
      for (std::size_t i = 0; i < 3; ++i) corner[i] = position.at(b, static_cast<std::size_t>(kTriangleCorners[t][i]));
      const Vec3 normal = (corner[1] - corner[0]).cross(corner[2] - corner[0]).normalized();
      const std::size_t across = t / 4;
      const std::size_t u = across == 0 ? 1 : 0;
      const std::size_t v = across == 2 ? 1 : 2;
      const auto halfU = static_cast<float>(0.5 * meanEdge(position, b, u).norm());
      const auto halfV = static_cast<float>(0.5 * meanEdge(position, b, v).norm());
      for (std::size_t i = 0; i < 3; ++i) {
        const auto number = static_cast<std::size_t>(kTriangleCorners[t][i]);
        Vertex vertex{};
        for (std::size_t a = 0; a < 3; ++a) {
          vertex.position[a] = static_cast<float>(corner[i][static_cast<Eigen::Index>(a)]);
          vertex.normal[a] = static_cast<float>(normal[static_cast<Eigen::Index>(a)]);
        }
        vertex.half = {halfU, halfV};
        vertex.inFace = {static_cast<float>(cornerSide(number, u)) * halfU, static_cast<float>(cornerSide(number, v)) * halfV};
        vertex.colour = colours[b];
        vertex.block = static_cast<std::int32_t>(b);
        mesh.push_back(vertex);
      }
    }
  }
}

void addLine(const Vec3& from, const Vec3& to, const Colour& colour, const Camera& camera, double width_m,
             std::vector<Vertex>& mesh) {
  Vec3 side = (to - from).cross(cameraFrame(camera).eye - from);
  if (side.norm() == 0.0) return;  // seen from its end
  side *= 0.5 * width_m / side.norm();
  addTriangle(from - side, from + side, to + side, colour, mesh);
  addTriangle(from - side, to + side, to - side, colour, mesh);
}

void addArrow(const Vec3& from, const Vec3& to, const Colour& colour, const Camera& camera, double width_m,
              std::vector<Vertex>& mesh) {
  const Vec3 along = to - from;
  const double length = along.norm();
  if (length == 0.0) return;
  Vec3 side = along.cross(cameraFrame(camera).eye - from);
  if (side.norm() == 0.0) return;  // seen from its tip
  side *= 0.5 * width_m / side.norm();
  const Vec3 neck = to - along * std::min(0.4, 3.0 * width_m / length);
  addTriangle(from - side, from + side, neck + side, colour, mesh);
  addTriangle(from - side, neck + side, neck - side, colour, mesh);
  addTriangle(neck - 2.5 * side, neck + 2.5 * side, to, colour, mesh);
}

void addContactArrows(const Session& session, const Camera& camera, std::vector<Vertex>& mesh) {
  constexpr double kWidth_m = 0.0012;
  for (const ContactForce& contact : session.contacts) {
    // On the block that lies above, whichever the engine calls upper.
    Vec3 force = contact.normalForce * contact.normal + contact.frictionForce;
    if (contact.normal.z() < 0.0) force = -force;
    const double size = force.norm();
    if (size < kMinForce_n) continue;
    const Vec3 arrow = force * (std::max(kMetresPerNewton * size, kShortestArrow_m) / size);
    addArrow(contact.point, contact.point + arrow, contact.sliding ? kSlips : kSticks, camera, kWidth_m, mesh);
  }
}

Colour holdColour(Hold hold) {
  return hold == Hold::slips ? kSlips : hold == Hold::sticks ? kSticks : kFree;
}

void addGuide(const Session& session, const Guide& guide, const Hand& hand, const Camera& camera, std::vector<Vertex>& mesh) {
  constexpr double kWidth_m = 0.0012;
  if (guide.lead == Lead::pulling) {
    const Vec3 middle = centre(session.simulation.state.position, index(guide.block));
    const double length = kLineInLengths * session.simulation.model.dimensions[index(guide.block)].maxCoeff();
    addArrow(middle, middle + length * hand.line, kFree, camera, kWidth_m, mesh);
  }
  if (!showsLanding(guide)) return;
  const Landing& landing = guide.landing;
  const Vec3 half = 0.5 * session.simulation.model.dimensions[index(guide.block)];
  std::array<Vec3, kCorners> corner;
  for (std::size_t c = 0; c < kCorners; ++c) {
    const Vec3 side(cornerSide(c, 0), cornerSide(c, 1), cornerSide(c, 2));
    corner[c] = landing.place.centre + landing.place.turn * side.cwiseProduct(half);
  }
  for (std::size_t a = 0; a < kCorners; ++a) {
    for (const std::size_t bit : {1U, 2U, 4U}) {
      if ((a & bit) == 0) addLine(corner[a], corner[a | bit], landing.fits ? kSticks : kSlips, camera, kWidth_m, mesh);
    }
  }
}

void addHand(const Session& session, const Hand& hand, const ParticleArray& position, const Camera& camera,
             std::vector<Vertex>& mesh) {
  constexpr double kWidth_m = 0.003;
  if (hand.block == kFloor) return;
  addArrow(centre(position, index(hand.block)), hand.place, holdColour(session.hold), camera, kWidth_m, mesh);
}

}  // namespace springtower
