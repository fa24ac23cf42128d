#pragma once

#include "solver/contact_force.h"
#include "solver/engine.h"

#include <span>

namespace springtower {

/// One island on its way through one frame: what a method's step needs, and where it may write. Everything it touches belongs to
/// the island alone, so islands run side by side.
struct IslandStep {
  Simulation& simulation;
  Engine& engine;
  std::span<const std::int32_t> blocks;
  std::span<const std::int32_t> pairs;  ///< positions in engine.pairs
  Counters& counters;
  StageTimes& times;
  ContactLaw law;
  Vec3 gravity = Vec3::Zero();  ///< m/s2, at the step's time
  double time_s = 0.0;          ///< s, start of the step
  double drift_s = 0.0;         ///< s; step of the positions
  double kick_s = 0.0;          ///< s; step of the velocities: mean of the last and this drift (leapfrog with changing steps)
  double advance_s = 0.0;       ///< s by which the contact memory is behind the positions
  double scaleMost = 1.0;       ///< most a contact that is born now may be stiffened
  /// Pairs that touch or may use up their margin soon: all, but in steps so short that it is worth listing them.
  std::span<const std::int32_t> watched = pairs;
  bool lists = false;     ///< whether the steps are so short
  int listedFor = 0;      ///< steps for which `watched` still holds
  bool rigid = false;     ///< whether rigid steps carry the island: its points remember forces
  bool unforced = false;  ///< neither user forces nor the hand act: the equilibrium before the first frame
};

/// What becomes of the contact memory that a force evaluation has brought up to date: dropped, kept, or put into engine.trial,
/// where an implicit step keeps it until it is accepted.
enum class Memory { drop, advance, trial };

/// Forces on the island's corners at `state`: springs, contacts, user forces and the hand's tether (gravity is an acceleration
/// and comes with the integration); fills engine.force for its blocks. `carried` are the velocities that moved the positions
/// during the last `advance_s`, to which a copy of the contact memory is brought. Deterministic: contacts are summed in the order
/// of the pairs for any number of threads.
void evaluateForces(IslandStep& step, const MotionState& state, const CornerArray& carried, double advance_s, Memory memory);

/// Whether the hand holds a block of this island; whether a user force acts on one during the frame.
bool holdsTether(const IslandStep& step);
bool isPushed(const IslandStep& step);

/// Acceleration of one block's corners from engine.force and gravity: a_i = (own f_i - shared F) / m + g.
void accelerate(const IslandStep& step, std::size_t block, double (&acceleration)[3][kCorners]);

/// The methods: each advances simulation.state by one step and leaves the positions it started from in engine.previous. The
/// contact memory is brought up to date once a step.
void stepSemiImplicitEuler(IslandStep& step);
void stepMidpoint(IslandStep& step);
void stepRungeKutta4(IslandStep& step);
void stepReport(IslandStep& step);

/// Adds the path of the step just taken to each block's travel. Returns false when a block has left its swept box, so that the
/// frame has to be run again with a wider one. Throws DivergenceError when a position is not finite or moved too far.
bool addTravel(IslandStep& step);

/// Before the first frame: blocks that touch as they are placed get their contacts at once (cubic tests without motion).
void findTouching(IslandStep& step);

/// Path, m, of both blocks of a pair together after which their manifold is renewed: where no point slides, where one does, and
/// where none does but at most two push, so that one block may roll on the other.
struct RenewalTravel {
  double resting_m;
  double sliding_m;
  double rolling_m;
};
RenewalTravel renewalOfExplicitSteps(const Simulation& simulation);
RenewalTravel renewalOfImplicitSteps(const Simulation& simulation);

/// Looks after the pairs of an island once a step has moved it: finds new contacts by the cubic tests, renews manifolds whose
/// blocks have moved, and lets go of those that parted. Adds the step's path to each block's travel. Returns false when a block
/// has left its swept box, so that the frame has to be run again with a wider one. Throws DivergenceError.
bool updateContacts(IslandStep& step, const RenewalTravel& renewal);

/// The same in two parts, for steps that are taken again with the contacts found in them: what has met, as often as the step is
/// taken; then, once it stands, the manifolds whose blocks have moved.
bool findContacts(IslandStep& step);

/// Between two such attempts, when blocks and their travel are back where the step began: margins that the attempt has measured,
/// at its end, are measured again, and manifolds that it has begun, of blocks that had passed each other, are renewed where the
/// step ends.
void measureAgain(IslandStep& step);
void renewContacts(IslandStep& step, const RenewalTravel& renewal);

}  // namespace springtower
