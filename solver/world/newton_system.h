#pragma once

#include "core/lanes.h"
#include "core/vector.h"
#include "solver/algebra/block_ldlt.h"
#include "solver/algebra/elimination_order.h"
#include "solver/block/stiffness_matrix.h"

#include <array>
#include <cstdint>
#include <vector>

namespace springtower {

/// Which points of a pair's manifold push (low byte) and which of them slide (high byte).
using ActiveSetBits = std::uint16_t;

/// How the forces of up to four points of a pair on upper change with the displacement g of upper against lower at each of them:
/// isotropic g + n alongNormal (n . g) + s (alongSlip (s . g) + coupling (n . g)), n the normal and s the way of sliding.
/// Friction follows the normal force by `coupling`; and what slides pushes at another place of the lower block.
struct alignas(sizeof(Lanes)) ContactTangent {  // its AVX2 kernel counts on that; without AVX2 the compiler aligns by half of it
  std::int32_t upper = -1;                      ///< nodes of the blocks; -1: the floor, or asleep
  std::int32_t lower = -1;
  double normal[3] = {0.0, 0.0, 0.0};
  double dual[3][3] = {};     ///< 1/m, of the lower block
  Lanes upperWeight[3] = {};  ///< of each of the block's sides
  Lanes lowerWeight[3] = {};
  Lanes isotropic = {};  ///< N/m
  Lanes alongNormal = {};
  Lanes alongSlip = {};
  Lanes coupling = {};
  Lanes slip[3] = {};
  Lanes push[3] = {};  ///< N, force on upper of the points that slide
};

/// The hand's springs and dashpots as factors are made for them.
struct TetherStiffness {
  BlockId block = kFloor;
  double centre = 0.0;  ///< N/m, in an implicit step, where nothing is at its limit
  double corner = 0.0;  ///< N/m, of one corner about the centre, level
  double tilt = 0.0;    ///< N/m, the same up and down
  bool operator==(const TetherStiffness&) const = default;
};

/// What Newton's iteration works with inside a step; nothing in it is read before it is written in the same step.
struct NewtonWork {
  std::vector<ModeVectors> residual;       ///< N, in the blocks' frames, by node
  std::vector<ModeVectors> direction;      ///< m, the last correction, in the world's frame, by node
  std::vector<double> affine;              ///< right-hand sides and solutions, [nodes][12]
  AlignedVector<ContactTangent> tangents;  ///< what is to be added to what the factors know; may be empty
  std::vector<std::int32_t> coupled;       ///< of `solveCoupled`: nodes that the tangents touch
  std::vector<std::int32_t> coupledAs;     ///< and where each node is among them
  std::vector<double> coupledMotion;       ///< m, [coupled][12]
  std::vector<double> coupledForce;        ///< N, [direction][coupled][12]
  std::vector<double> correction;          ///< m, [direction][nodes][12]
};

/// What an island keeps from implicit step to implicit step: the factors of M / step^2 + K as the contacts stood when they were
/// last assembled, and working space of the iteration.
struct NewtonSystem : NewtonWork {
  /// Blocks of one size and mass share their own matrix.
  struct BlockClass {
    Vec3 dimensions;  ///< m
    double mass;      ///< kg
    BlockJacobian jacobian;
  };
  std::uint64_t pattern = 0;  ///< of which blocks touch which; what the matrix is laid out for
  bool exceedsFill = false;   ///< so much fills in that there are no factors
  bool factorised = false;
  double step_s = 0.0;                ///< the step times the method's factor that the factors are for
  TetherStiffness tether;             ///< the hand's springs that the factors contain
  bool limited = false;               ///< whether one of them was at its limit then
  int directions = 0;                 ///< that the last correction took beside the factors
  bool trialIsAhead = false;          ///< whether the contacts' trial points are of a state after the step's start
  bool useConsistentTangent = false;  ///< whether the iteration is so near the solution that contacts may be taken as they stand
  bool forcesKnown = false;           ///< engine.memo.force holds the forces at the island's present state
  BlockCholesky matrix;
  std::vector<std::int32_t> touching;                      ///< touching pairs, as positions in engine.pairs
  std::vector<BlockSlot> slot;                             ///< of each of these; at = -1 where one side is the floor or asleep
  std::vector<ActiveSetBits> mask;                         ///< what each of these was assembled for
  std::vector<std::array<std::array<double, 3>, 3>> axes;  ///< the frames the blocks were assembled in, [node][axis][component]
  std::vector<BlockClass> kinds;                           ///< of the island's blocks; maybe more than it has now
  std::vector<std::int32_t> blockClassOf;                  ///< of each node
  double jacobianStep_s = 0.0;                             ///< what step these are for
  AlignedVector<ContactTangent> factorTangents;            ///< what the factors know of pairs that slid when they were made
  EliminationOrder order;                                  ///< in which the matrix is laid out
  std::uint64_t members = 0;                               ///< of the blocks that this order was found for
  std::size_t orderProducts = 0;                           ///< products of a factorisation then
  std::vector<BlockPair> edges;                            ///< nodes that touching pairs couple, as last laid out
};

/// The own matrix of a node's block.
inline const BlockJacobian& jacobianOf(const NewtonSystem& island, std::size_t node) {
  return island.kinds[static_cast<std::size_t>(island.blockClassOf[node])].jacobian;
}

}  // namespace springtower
