#include "apps/viewer/view/mesh.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace springtower {
namespace {

constexpr double kMinForce_n = 1e-3;
constexpr double kMetresPerNewton = 0.01;
constexpr double kShortestArrow_m = 0.003;
constexpr double kLineInLengths = 1.5;  // of the line along which a block is pulled

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

void blockMesh(const ParticleArray& position, std::span<const Colour> colours, std::vector<Vertex>& mesh) {
  for (std::size_t b = 0; b < position.blockCount(); ++b) {
    std::array<float, 3> half{};
    for (std::size_t a = 0; a < 3; ++a) half[a] = static_cast<float>(0.5 * meanEdge(position, b, a).norm());
    for (std::size_t t = 0; t < kTriangles; ++t) {
      std::array<Vec3, 3> corner;
      for (std::size_t i = 0; i < 3; ++i) corner[i] = position.at(b, static_cast<std::size_t>(kTriangleCorners[t][i]));
      const Vec3 normal = (corner[1] - corner[0]).cross(corner[2] - corner[0]).normalized();
      for (std::size_t i = 0; i < 3; ++i) {
        const auto number = static_cast<std::size_t>(kTriangleCorners[t][i]);
        Vertex vertex{};
        for (std::size_t a = 0; a < 3; ++a) {
          vertex.position[a] = static_cast<float>(corner[i][static_cast<Eigen::Index>(a)]);
          vertex.normal[a] = static_cast<float>(normal[static_cast<Eigen::Index>(a)]);
          vertex.local[a] = half[a] * static_cast<float>(cornerSide(number, a));
        }
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
    addArrow(contact.point, contact.point + arrow, holdColour(contact.sliding ? Hold::slips : Hold::sticks), camera, kWidth_m,
             mesh);
  }
}

void addMargin(const ParticleArray& position, const std::optional<StabilityMargin>& margin, std::vector<Vertex>& mesh) {
  constexpr double kFoot_m = 0.02;    // a block whose lowest corner is below that stands on the floor
  constexpr double kBeside_m = 0.03;  // from the farthest corner
  constexpr double kWidth_m = 0.006;
  constexpr double kOver_m = 0.0003;
  constexpr int kParts = 120;
  constexpr Colour kOpen = {0.22F, 0.17F, 0.14F};
  std::vector<Vec3> foot;
  Vec3 middle = Vec3::Zero();
  for (std::size_t b = 0; b < position.blockCount(); ++b) {
    for (std::size_t c = 0; c < kCorners; ++c) {
      if (position.at(b, c).z() < kFoot_m) foot.push_back(position.at(b, c));
    }
  }
  if (foot.empty()) return;
  for (const Vec3& corner : foot) middle += corner / static_cast<double>(foot.size());
  double radius = 0.0;
  for (const Vec3& corner : foot) radius = std::max(radius, (corner - middle).head<2>().norm());
  radius += kBeside_m;
  const double share = margin ? std::clamp(margin->tilt_deg / kFullMargin_deg, 0.0, 1.0) : 0.0;
  const double weak = margin ? margin->direction_deg * std::numbers::pi / 180.0 : 0.0;
  const Colour colour = marginColour(share);
  const auto at = [&](double part, double r) {
    const double angle = weak + 2.0 * std::numbers::pi * part;
    return Vec3(middle.x() + r * std::cos(angle), middle.y() + r * std::sin(angle), kOver_m);
  };
  for (int i = 0; i < kParts; ++i) {
    const double from = static_cast<double>(i) / kParts;
    const double to = static_cast<double>(i + 1) / kParts;
    const bool open = std::min(from + to, 2.0 - from - to) < 1.0 - share;  // the gap lies around the weak side
    const double width = open ? 0.25 * kWidth_m : kWidth_m;
    const Vec3 corner[] = {at(from, radius), at(to, radius), at(to, radius + width), at(from, radius + width)};
    addTriangle(corner[0], corner[3], corner[2], open ? kOpen : colour, mesh);
    addTriangle(corner[0], corner[2], corner[1], open ? kOpen : colour, mesh);
  }
}

void addGuide(const Session& session, const Guide& guide, const Hand& hand, const Camera& camera, std::vector<Vertex>& mesh) {
  constexpr double kWidth_m = 0.0012;
  if (guide.lead == Lead::pulling) {
    const Vec3 middle = centre(session.simulation.state.position, index(guide.block));
    const double length = kLineInLengths * session.simulation.model.dimensions[index(guide.block)].maxCoeff();
    addArrow(middle, middle + length * hand.line, holdColour(Hold::free), camera, kWidth_m, mesh);
  }
  if (!showsLanding(guide)) return;
  const Landing& landing = guide.landing;
  const Colour colour = holdColour(landing.fits ? Hold::sticks : Hold::slips);
  const Vec3 half = 0.5 * session.simulation.model.dimensions[index(guide.block)];
  std::array<Vec3, kCorners> corner;
  for (std::size_t c = 0; c < kCorners; ++c) {
    const Vec3 side(cornerSide(c, 0), cornerSide(c, 1), cornerSide(c, 2));
    corner[c] = landing.place.centre + landing.place.turn * side.cwiseProduct(half);
  }
  for (std::size_t a = 0; a < kCorners; ++a) {
    for (const std::size_t bit : {1U, 2U, 4U}) {
      if ((a & bit) == 0) addLine(corner[a], corner[a | bit], colour, camera, kWidth_m, mesh);
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
