#include "solver/fall_steps.h"

#include "solver/inertia.h"
#include "solver/meeting.h"
#include "solver/stability.h"
#include "solver/stiffness.h"

#include <algorithm>
#include <cmath>

namespace springtower {

namespace {

constexpr int kMostFallSteps = 6000;
// Share of the stability limit that is used. Points that come and go within steps as long as the limit allows would give and take
// some of a contact's energy each time: at 0.95 impacts are twice as deep.
constexpr double kFallMargin = 0.7;
// How fast blocks that turn and pass one another are counted on to close at least, of their corners' speeds.
constexpr double kClosingShare = 0.5;

// How fast a pair closes along what separated its blocks last, m/s.
double closingSpeed(const IslandStep& step, const NearPair& pair) {
  const CornerArray& velocity = step.simulation.state.velocity;
  const auto a = static_cast<std::size_t>(pair.a);
  double slowest = 1e300;
  for (std::size_t c = 0; c < kCorners; ++c) slowest = std::min(slowest, pair.witness.dot(velocity.at(a, c)));
  if (pair.b < 0) return -slowest;
  double fastest = -1e300;
  for (std::size_t c = 0; c < kCorners; ++c)
    fastest = std::max(fastest, pair.witness.dot(velocity.at(static_cast<std::size_t>(pair.b), c)));
  return fastest - slowest;
}

// How fast corners of a pair's blocks may meet at most, whichever they are, m/s.
double meetingSpeed(const IslandStep& step, const NearPair& pair) {
  const CornerArray& velocity = step.simulation.state.velocity;
  const auto a = static_cast<std::size_t>(pair.a);
  const Vec3 along = centre(velocity, a);
  if (pair.b < 0) return fastestCorner(velocity, a, along) + std::abs(along.z());
  const auto b = static_cast<std::size_t>(pair.b);
  const Vec3 common = 0.5 * (along + centre(velocity, b));
  return fastestCorner(velocity, a, common) + fastestCorner(velocity, b, common);
}

// What may meet in an island that falls during this frame.
struct FallApproach {
  double speed = 0.0;     // m/s, largest at which any two of its near blocks may meet
  double lightest = 0.0;  // kg, least reduced mass of these; 0 where none may meet
  bool meeting = false;   // whether blocks that are apart may meet at all
  int together = 1;       // most pairs of any one block that may begin to push: hit at once they add up
};

FallApproach approachOf(const IslandStep& step) {
  const Simulation& simulation = step.simulation;
  std::vector<std::int32_t>& beginning = step.engine.beginning;
  for (const std::int32_t block : step.blocks) beginning[static_cast<std::size_t>(block)] = 0;
  const double frame_s = simulation.scene.settings.frame_s;
  const double gained = simulation.scene.gravity.magnitude * frame_s;
  FallApproach approach;
  for (const std::int32_t at : step.pairs) {
    const NearPair& pair = step.engine.pairs[static_cast<std::size_t>(at)];
    const double speed = meetingSpeed(step, pair);
    const bool apart = pair.manifold.touch == Touch::apart;
    if (apart) {
      const double closing = std::max(kClosingShare * speed, closingSpeed(step, pair)) + gained;
      if (pair.margin - (travelOf(step.engine, pair) - pair.checkedTravel) > closing * frame_s) continue;
      approach.meeting = true;
    }
    if (apart || !anyPointTouches(pair.manifold)) {
      approach.together = std::max(approach.together, ++beginning[static_cast<std::size_t>(pair.a)]);
      if (pair.b >= 0) approach.together = std::max(approach.together, ++beginning[static_cast<std::size_t>(pair.b)]);
    }
    const double massA = simulation.model.mass[static_cast<std::size_t>(pair.a)];
    const double massB = pair.b < 0 ? 0.0 : simulation.model.mass[static_cast<std::size_t>(pair.b)];
    const double reduced = pair.b < 0 ? massA : massA * massB / (massA + massB);
    approach.speed = std::max(approach.speed, speed + gained);
    approach.lightest = approach.lightest > 0.0 ? std::min(approach.lightest, reduced) : reduced;
  }
  return approach;
}

}  // namespace

int chooseFallSteps(IslandStep& step) {
  Simulation& simulation = step.simulation;
  const Settings& settings = simulation.scene.settings;
  BlockClock& record = step.engine.clock[static_cast<std::size_t>(step.blocks.front())];
  const std::uint64_t signature = ~contactSignature(step.engine, step.pairs) ^ (step.blocks.size() << 1U);
  if (signature != record.contactSignature) {
    record.spectralRadius = spectralBound(simulation, step.blocks, step.pairs, true);
    record.contactSignature = signature;
  }
  const double standing = record.spectralRadius;
  const FallApproach approach = approachOf(step);
  // What a contact adds to that, over its stiffness for the reduced mass: corners of blocks that keep their shape meet.
  const double perRate = 2.0 * (1.0 + settings.viscoelasticRatio) * rigidCornerInverseMass(settings.inertia);
  const double resting =
      approach.lightest > 0.0 ? perRate * step.law.restingScale * simulation.contactStiffness_n_m / approach.lightest : 0.0;
  const double depth = step.law.impactPenetration_m;
  const double hardest = perRate * approach.speed * approach.speed / (depth * depth);
  const double needed = standing + (approach.meeting || hardest > resting ? std::max(approach.together * resting, hardest) : 0.0);
  const double dt = stableStep(settings.method, needed, simulation.dampingTime_s, kFallMargin);
  const int steps = std::clamp(static_cast<int>(std::ceil(settings.frame_s / dt)), 1, kMostFallSteps);
  const double allowed = stableSpectralRadius(settings.method, settings.frame_s / steps, simulation.dampingTime_s, kFallMargin);
  step.bornMost_s2 = std::max(0.0, allowed - standing) / (approach.together * perRate);
  return steps;
}

}  // namespace springtower
