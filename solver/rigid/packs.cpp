#include "solver/rigid/packs.h"

#include "core/reserve_closely.h"

#include <algorithm>
#include <bit>
#include <limits>
#include <numeric>

namespace springtower {

namespace {

// Where pairs come to lie in packs: those of a colour side by side, of these first the ones that push, with as many points.
constexpr std::int32_t kMostPoints = static_cast<std::int32_t>(kMostNearPoints);
constexpr int kSharedColours = 64;  // of each kind; pairs beyond have one of their own
constexpr std::int32_t kKeysOfColour = 2 * (kMostPoints + 1);

std::size_t packedRow(std::int32_t first, std::int32_t i) {
  return static_cast<std::size_t>(first) + static_cast<std::size_t>(i);
}

bool movesByImpulses(const RigidIsland& island, std::int32_t body) {
  return body != unmovedBody(island) && island.bodies[static_cast<std::size_t>(body)].inverseMass > 0.0;
}

// A pair's colour among those of its kind, in the order in which the kinds are solved: contacts with what does not move come
// after all others, as what these leave must not push blocks into the floor. Where all colours are taken, a pair has one of its
// own.
enum class ColourKind : std::uint8_t { amongMoving, withUnmoved, own };
struct Colour {
  ColourKind kind = ColourKind::own;
  std::int32_t number = 0;
};

// The first colour that neither body has; both have it then. `owns`: pairs so far that have one of their own.
Colour takeColour(const RigidIsland& island, const ContactConstraint& point, std::vector<std::array<std::uint64_t, 2>>& taken,
                  std::int32_t& owns) {
  const bool moves[2] = {movesByImpulses(island, point.upper), movesByImpulses(island, point.lower)};
  const ColourKind kind = moves[0] && moves[1] ? ColourKind::amongMoving : ColourKind::withUnmoved;
  const auto k = static_cast<std::size_t>(kind);
  std::uint64_t colours = 0;
  if (moves[0]) colours |= taken[static_cast<std::size_t>(point.upper)][k];
  if (moves[1]) colours |= taken[static_cast<std::size_t>(point.lower)][k];
  const int colour = std::countr_one(colours);
  if (colour == kSharedColours) return {ColourKind::own, owns++};
  if (moves[0]) taken[static_cast<std::size_t>(point.upper)][k] |= std::uint64_t{1} << colour;
  if (moves[1]) taken[static_cast<std::size_t>(point.lower)][k] |= std::uint64_t{1} << colour;
  return {kind, colour};
}

// Sorts the groups that have points by colour, then by what is side by side.
void sortGroups(const RigidIsland& island, const PointList& list, PackedPoints& packed) {
  packed.taken.assign(island.bodies.size(), {0, 0});
  packed.key.assign(list.groups.size(), -1);
  packed.kind.resize(list.groups.size());
  std::array<std::int32_t, 3> colours{};  // of each kind
  std::int32_t owns = 0;
  for (std::size_t g = 0; g < list.groups.size(); ++g) {
    const PointGroup& group = list.groups[g];
    if (group.count == 0) continue;
    const auto first = list.points.begin() + group.first;
    const Colour colour = takeColour(island, *first, packed.taken, owns);
    const bool idle = std::all_of(first, first + group.count, [](const ContactConstraint& p) { return p.idle; });
    packed.kind[g] = static_cast<std::uint8_t>(colour.kind);
    packed.key[g] = colour.number * kKeysOfColour + (idle ? kMostPoints + 1 : 0) + kMostPoints - group.count;
    colours[packed.kind[g]] = std::max(colours[packed.kind[g]], colour.number + 1);
  }
  const std::array<std::int32_t, 3> before = {0, colours[0], colours[0] + colours[1]};
  for (std::size_t g = 0; g < list.groups.size(); ++g) {
    if (packed.key[g] >= 0) packed.key[g] += before[packed.kind[g]] * kKeysOfColour;
  }
  const std::int32_t last = (before[2] + colours[2]) * kKeysOfColour - 1;
  packed.keyStart.assign(static_cast<std::size_t>(last) + 2, 0);
  for (const std::int32_t key : packed.key) {
    if (key >= 0) ++packed.keyStart[static_cast<std::size_t>(key) + 1];
  }
  for (std::size_t k = 1; k < packed.keyStart.size(); ++k) packed.keyStart[k] += packed.keyStart[k - 1];
  packed.order.resize(static_cast<std::size_t>(packed.keyStart.back()));
  for (std::size_t g = 0; g < list.groups.size(); ++g) {
    if (packed.key[g] < 0) continue;
    packed.order[static_cast<std::size_t>(packed.keyStart[static_cast<std::size_t>(packed.key[g])]++)] =
        static_cast<std::int32_t>(g);
  }
}

// A pack without pairs.
void clearPack(const RigidIsland& island, PackedPair& pair) {
  pair.upper.fill(unmovedBody(island));
  pair.lower.fill(unmovedBody(island));
  pair.group.fill(-1);
  pair.active.fill(0);
  pair.rows = pair.pushing = pair.nearby = 0;
  pair.movesUpper = pair.movesLower = 0;
  pair.slips = false;
  pair.staticFriction = pair.kineticFriction = pair.restitution = Lanes{0.0, 0.0, 0.0, 0.0};
}

// Distributes the sorted groups over packs: a colour begins a new one.
void distribute(const RigidIsland& island, ActingPoints& list) {
  PackedPoints& packed = list.packed;
  packed.colourStart.clear();
  std::size_t used = 0;
  int lane = kPackedPairs;
  std::int32_t colour = -1;
  std::int32_t rows = 0;
  for (const std::int32_t g : packed.order) {
    PointGroup& group = list.groups[static_cast<std::size_t>(g)];
    const std::int32_t own = packed.key[static_cast<std::size_t>(g)] / kKeysOfColour;
    if (own != colour) packed.colourStart.push_back(static_cast<std::int32_t>(used));
    if (own != colour || lane == kPackedPairs) {
      if (packed.pairs.size() == used) {
        reserveClosely(used + 1, packed.pairs);
        packed.pairs.emplace_back();
      }
      clearPack(island, packed.pairs[used]);
      packed.pairs[used++].first = rows;
      lane = 0;
    }
    colour = own;
    PackedPair& pair = packed.pairs[used - 1];
    pair.group[static_cast<std::size_t>(lane)] = g;
    rows += std::max(0, group.count - pair.rows);
    pair.rows = std::max(pair.rows, group.count);
    group.pack = static_cast<std::int32_t>(used) - 1;
    group.lane = lane++;
  }
  packed.colourStart.push_back(static_cast<std::int32_t>(used));
  packed.pairs.resize(used);
  reserveClosely(static_cast<std::size_t>(rows), packed.points);
  reserveClosely(static_cast<std::size_t>(rows), packed.places);
  packed.points.resize(static_cast<std::size_t>(rows));
  packed.places.resize(static_cast<std::size_t>(rows));
}

void clearRow(PackedPoint& point, PackedPlace& place) {
  const Lanes zero = {0.0, 0.0, 0.0, 0.0};
  place = PackedPlace{};
  place.rest = zero + std::numeric_limits<double>::max();
  setZero(point.friction);
  setZero(point.towardsCentre);
  point.push = point.normalMass = point.impact = point.before = point.softness = point.deepest = zero;
  point.idle = zero == zero;
  point.sliding = zero != zero;
}

void fillLane(const ContactConstraint& from, double compliance, int lane, PackedPoint& point, PackedPlace& place) {
  setLane(place.upper, lane, from.placeUpper);
  setLane(place.lower, lane, from.placeLower);
  setLane(place.normal, lane, from.ownNormal);
  const std::int64_t turns = from.normalOf == NormalOf::a ? kTurnsUpper : from.normalOf == NormalOf::b ? kTurnsLower : 0;
  place.kind[lane] = turns | kAxisBit << from.axis;
  place.rest[lane] = from.rest;
  place.beside[lane] = from.beside;
  setLane(point.friction, lane, from.friction);
  point.push[lane] = from.push;
  point.before[lane] = from.before;
  place.compliance[lane] = compliance;
  place.lasting[lane] = from.lasting;
  point.normalMass[lane] = 1.0;
  point.idle[lane] = from.idle ? -1 : 0;
  point.sliding[lane] = from.sliding ? -1 : 0;
}

void fillPack(const IslandStep& step, const RigidIsland& island, ActingPoints& list, PackedPair& pair) {
  PackedPoints& packed = list.packed;
  for (std::int32_t row = 0; row < pair.rows; ++row)
    clearRow(packed.points[packedRow(pair.first, row)], packed.places[packedRow(pair.first, row)]);
  for (int lane = 0; lane < kPackedPairs; ++lane) {
    const auto l = static_cast<std::size_t>(lane);
    if (pair.group[l] < 0) continue;
    const PointGroup& group = list.groups[static_cast<std::size_t>(pair.group[l])];
    const ContactConstraint& any = list.points[static_cast<std::size_t>(group.first)];
    pair.upper[l] = any.upper;
    pair.lower[l] = any.lower;
    pair.movesUpper |= static_cast<std::uint8_t>((movesByImpulses(island, any.upper) ? 1U : 0U) << l);
    pair.movesLower |= static_cast<std::uint8_t>((movesByImpulses(island, any.lower) ? 1U : 0U) << l);
    const BlockPair& key = step.engine.pairs.key[static_cast<std::size_t>(group.pair)];
    const Friction friction = step.simulation.friction.of(key.a, key.b);
    pair.staticFriction[lane] = friction.staticFriction;
    pair.kineticFriction[lane] = friction.kineticFriction;
    pair.restitution[lane] = any.restitution;
    const bool soft = !isRigid(step.simulation.scene.settings.method);
    const double compliance = soft ? 1.0 / pairStiffness(step.simulation.stiffness, key.a, key.b) : 0.0;
    for (std::int32_t i = 0; i < group.count; ++i)
      fillLane(list.points[packedRow(group.first, i)], compliance, lane, packed.points[packedRow(pair.first, i)],
               packed.places[packedRow(pair.first, i)]);
  }
}

}  // namespace

void packPoints(const IslandStep& step, const RigidIsland& island, ActingPoints& list) {
  PackedPoints& packed = list.packed;
  packed.active.clear();
  packed.activeStart.clear();
  packed.activePoints = 0;
  packed.bodyStart.clear();
  if (list.points.empty()) {
    packed.pairs.clear();
    packed.points.clear();
    packed.places.clear();
    packed.colourStart.clear();
    return;
  }
  sortGroups(island, list, packed);
  distribute(island, list);
  overPacks(packed, [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) fillPack(step, island, list, packed.pairs[i]);
  });
}

void listPairsOfBodies(const RigidIsland& island, PackedPoints& packed) {
  if (!packed.bodyStart.empty()) return;
  packed.bodyStart.assign(island.bodies.size() + 1, 0);
  const auto forEach = [&](const auto& visit) {
    for (std::size_t i = 0; i < packed.pairs.size(); ++i) {
      for (std::size_t lane = 0; lane < kPackedPairs; ++lane) {
        for (const std::int32_t body : {packed.pairs[i].upper[lane], packed.pairs[i].lower[lane]}) {
          if (body != unmovedBody(island)) visit(static_cast<std::size_t>(body), static_cast<std::int32_t>(i));
        }
      }
    }
  };
  forEach([&](std::size_t body, std::int32_t) { ++packed.bodyStart[body]; });
  std::partial_sum(packed.bodyStart.begin(), packed.bodyStart.end(), packed.bodyStart.begin());
  packed.bodyPairs.resize(static_cast<std::size_t>(packed.bodyStart.back()));
  forEach([&](std::size_t body, std::int32_t i) { packed.bodyPairs[static_cast<std::size_t>(--packed.bodyStart[body])] = i; });
}

void unpackGroup(ActingPoints& list, const PointGroup& group) {
  if (group.count == 0) return;
  const PackedPair& pair = list.packed.pairs[static_cast<std::size_t>(group.pack)];
  for (std::int32_t i = 0; i < group.count; ++i) {
    const PackedPoint& from = list.packed.points[packedRow(pair.first, i)];
    ContactConstraint& to = list.points[packedRow(group.first, i)];
    getLane(from.friction, group.lane, to.friction);
    to.push = from.push[group.lane];
    to.before = from.before[group.lane];
    const PackedPlace& place = list.packed.places[packedRow(pair.first, i)];
    to.rest = place.rest[group.lane];
    to.lasting = place.lasting[group.lane];
    to.idle = from.idle[group.lane] != 0;
    to.sliding = from.sliding[group.lane] != 0;
  }
}

void unpackPoints(ActingPoints& list) {
  forRanges(list.groups.size(), tuning::kPairGrain, list.groups.size() >= 2 * tuning::kPairGrain,
            [&](std::size_t first, std::size_t last) {
              for (std::size_t g = first; g < last; ++g) unpackGroup(list, list.groups[g]);
            });
}

void disablePacked(PackedPoints& packed, const PointGroup& group) {
  const PackedPair& pair = packed.pairs[static_cast<std::size_t>(group.pack)];
  for (std::int32_t i = 0; i < group.count; ++i) {
    const auto row = packedRow(pair.first, i);
    PackedPoint& point = packed.points[row];
    packed.places[row].rest[group.lane] = std::numeric_limits<double>::max();
    point.push[group.lane] = 0.0;
    point.friction.x[group.lane] = point.friction.y[group.lane] = point.friction.z[group.lane] = 0.0;
    point.idle[group.lane] = -1;
  }
}

}  // namespace springtower
