#pragma once

#include "solver/block_cholesky.h"
#include "solver/block_frames.h"
#include "solver/block_jacobian.h"
#include "solver/contact_tangent.h"
#include "solver/elimination_order.h"

#include <array>
#include <cstdint>
#include <vector>

namespace springtower {

/// The hand's springs and dashpots as factors are made for them.
struct TetherStiffness {
  BlockId block = kFloor;
  double centre = 0.0;  ///< N/m, in an implicit step, where nothing is at its limit
  double corner = 0.0;  ///< N/m, of one corner about the centre, level
  double tilt = 0.0;    ///< N/m, the same up and down
  bool operator==(const TetherStiffness&) const = default;
};

/// What an island keeps from implicit step to implicit step: the factors of M / step^2 + K as the contacts stood when they were
/// last assembled, and working space of the iteration.
struct ImplicitIsland {
  /// Blocks of one size and mass share their own matrix.
  struct Kind {
    Vec3 dimensions;  ///< m
    double mass;      ///< kg
    BlockJacobian jacobian;
  };
  std::uint64_t pattern = 0;  ///< of which blocks touch which; what the matrix is laid out for
  bool tooDense = false;      ///< so much fills in that there are no factors
  bool factorised = false;
  double step_s = 0.0;       ///< the step times the method's factor that the factors are for
  TetherStiffness tether;    ///< the hand's springs that the factors contain
  bool limited = false;      ///< whether one of them was at its limit then
  int directions = 0;        ///< that the last correction took beside the factors
  bool moved = false;        ///< whether engine.trial holds a state after the step's start
  bool near = false;         ///< whether the iteration is so near the solution that contacts may be taken as they stand
  bool forcesKnown = false;  ///< engine.force holds the forces at the island's present state
  BlockCholesky matrix;
  std::vector<std::int32_t> touching;                      ///< touching pairs, as positions in engine.pairs
  std::vector<BlockSlot> slot;                             ///< of each of these; at = -1 where one side is the floor or asleep
  std::vector<ContactMask> mask;                           ///< what each of these was assembled for
  std::vector<std::array<std::array<double, 3>, 3>> axes;  ///< the frames the blocks were assembled in, [node][axis][component]
  std::vector<ModeVectors> residual;                       ///< N, in the blocks' frames, by node
  std::vector<ModeVectors> direction;                      ///< m, the last correction, in the world's frame, by node
  std::vector<double> affine;                              ///< right-hand sides and solutions, [nodes][12]
  std::vector<Kind> kinds;                                 ///< of the island's blocks; maybe more than it has now
  std::vector<std::int32_t> kindOf;                        ///< of each node
  double jacobianStep_s = 0.0;                             ///< what step these are for
  AlignedVector<ContactTangent> factorTangents;            ///< what the factors know of pairs that slid when they were made
  AlignedVector<ContactTangent> tangents;                  ///< what is to be added to what they know; may be empty
  std::vector<std::int32_t> coupled;                       ///< working space of `solveCoupled`: nodes that the tangents touch
  std::vector<std::int32_t> coupledAs;                     ///< and where each node is among them
  std::vector<double> coupledMotion;                       ///< m, [coupled][12]
  std::vector<double> coupledForce;                        ///< N, [direction][coupled][12]
  std::vector<double> correction;                          ///< m, [direction][nodes][12]
  EliminationOrder order;                                  ///< in which the matrix is laid out
  std::uint64_t members = 0;                               ///< of the blocks that this order was found for
  std::size_t orderProducts = 0;                           ///< products of a factorisation then
  std::vector<BlockPair> edges;                            ///< nodes that touching pairs couple, as last laid out
};

/// Islands of more blocks than this may be so wide that their factors cost as much as dozens of solutions.
inline constexpr std::size_t kNarrowBlocks = 60;

/// The own matrix of a node's block.
inline const BlockJacobian& jacobianOf(const ImplicitIsland& island, std::size_t node) {
  return island.kinds[static_cast<std::size_t>(island.kindOf[node])].jacobian;
}

struct IslandStep;

/// Weights of a block's affine vectors at a place in space.
std::array<double, kAffine> weightsAt(const BlockFrame& frame, const Vec3& place);

/// Lays out the matrix anew where blocks have begun or ceased to touch, unless the island is too dense.
void layOut(IslandStep& step, ImplicitIsland& island);

/// The hand's springs on the island's block, wherever the hand is. `step_s` as in `assemble`.
TetherStiffness tetherStiffness(const IslandStep& step, double step_s);

/// Whether the hand is at a limit of its forces.
bool isTetherLimited(const IslandStep& step);

/// Assembles and factorises for contacts that stand as `mask` says. `step_s` is the step times the method's factor. Returns false
/// where the matrix is not positive definite.
bool assemble(IslandStep& step, ImplicitIsland& island, double step_s);

/// Solves for island.affine in place with the factors at hand: forces (N) in, displacements (m) out, in the world's frame, by
/// node. Precondition: island.factorised.
void solve(IslandStep& step, ImplicitIsland& island);

}  // namespace springtower
