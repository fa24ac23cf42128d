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

/// Which points of a pair's manifold push (first byte), which of them slide (second), and which push by their damping alone, as
/// their springs are spent (third).
using ActiveSetBits = std::uint32_t;
constexpr ActiveSetBits kPushBit = 0x1U;  ///< of point 0; that of point i is i places further
constexpr ActiveSetBits kSlideBit = 0x100U;
constexpr ActiveSetBits kSpentBit = 0x10000U;
constexpr ActiveSetBits kAllPoints = 0xFFU;  ///< times one of these: of all eight points

/// Linearised contact: how the forces of up to four points of a pair on upper change with the displacement g of upper against
/// lower at each of them: isotropic g + n alongNormal (n . g) + s (alongSlip (s . g) + coupling (n . g)), n the normal and s the
/// slip direction. `coupling`: friction follows the normal force. The force of a slipping point also acts at another place of the
/// lower block.
struct alignas(sizeof(Lanes)) ContactTangent {  // the AVX2 kernel relies on that; without AVX2 the compiler aligns to half of it
  std::int32_t upper = -1;                      ///< nodes of the blocks; -1: the floor, or asleep
  std::int32_t lower = -1;
  double normal[3] = {0.0, 0.0, 0.0};
  double dual[3][3] = {};     ///< 1/m, of the lower block
  bool followsPush = false;   ///< the friction of the points of the tangent before it, which acts elsewhere
  Lanes upperWeight[3] = {};  ///< weights of the point on each of the block's sides
  Lanes lowerWeight[3] = {};
  Lanes isotropic = {};  ///< N/m
  Lanes alongNormal = {};
  Lanes alongSlip = {};
  Lanes coupling = {};
  Lanes slip[3] = {};
  Lanes push[3] = {};  ///< N, force on upper of the points that slip
};

/// The hand's springs and dashpots as they enter the factors.
struct TetherStiffness {
  BlockId block = kFloor;
  double centre = 0.0;  ///< N/m, in an implicit step below the hand's limits
  double corner = 0.0;  ///< N/m, of one corner about the centre, horizontal
  double tilt = 0.0;    ///< N/m, the same, vertical
  bool operator==(const TetherStiffness&) const = default;
};

/// Working space of Newton's iteration within a step; nothing in it is read before it is written in the same step.
struct NewtonWork {
  std::vector<ModeVectors> residual;       ///< N, in the blocks' frames, by node
  std::vector<ModeVectors> direction;      ///< m, the last Newton direction, in the world's frame, by node
  std::vector<double> affine;              ///< right-hand sides and solutions, [nodes][12]
  AlignedVector<ContactTangent> tangents;  ///< differences to the contacts in the factors; may be empty
  std::vector<ActiveSetBits> active;       ///< active set of each touching pair as the present iteration begins
  std::vector<std::int32_t> tangentStart;  ///< of each touching pair, where tangents are found on many threads
  std::vector<std::int32_t> coupled;       ///< of `solveCoupled`: nodes that the tangents act on
  std::vector<std::int32_t> coupledIndex;  ///< index of each node among them
  std::vector<double> coupledMotion;       ///< m, [coupled][12]
  std::vector<double> coupledForce;        ///< N, [direction][coupled][12]
  std::vector<double> correction;          ///< m, [direction][nodes][12], of a narrow island
};

/// What an island keeps from implicit step to implicit step: the factors of M / step^2 + K for the contacts when they were last
/// assembled, and working space of the iteration.
struct NewtonSystem : NewtonWork {
  /// Blocks of equal size, mass and springs share their own matrix.
  struct BlockClass {
    Vec3 dimensions;  ///< m
    double mass;      ///< kg
    double edge_n_m;  ///< N/m, see BlockStiffness
    BlockJacobian jacobian;
  };
  std::uint64_t pattern = 0;  ///< hash of the pairs that touch, for which the matrix is laid out
  bool exceedsFill = false;   ///< whether fill exceeds kMaxFillProducts, so that there are no factors
  bool factorised = false;
  double step_s = 0.0;          ///< step times the method's factor, for which the factors were computed
  TetherStiffness tether;       ///< the hand's springs in the factors
  bool limited = false;         ///< whether one of them was at its limit then
  int directions = 0;           ///< GMRES directions that the last correction took beside the factors
  bool trialIsAhead = false;    ///< whether the trial points belong to a state after the step's start
  bool trialLags = false;       ///< whether the trial points are those with which the last accepted step began
  bool isNear = false;          ///< whether the residual is so small that points without a normal force count as open
  int changedIterations = 0;    ///< iterations of the last solution, after its first, whose active set is not that of the factors
  bool assumesSupport = false;  ///< whether every point of every manifold counts as pushing and sticking
  bool forcesKnown = false;     ///< whether engine.memo.force holds the forces at the island's present state
  BlockCholesky matrix;
  std::vector<std::int32_t> touching;                      ///< touching pairs, as positions in engine.pairs
  std::vector<BlockSlot> slot;                             ///< of each of these; at = -1 where one side is the floor or asleep
  std::vector<std::int32_t> taskPairs;                     ///< of a wide island: indices into `touching`, by task, the top last
  std::vector<std::int32_t> taskPairStart;                 ///< of task t: taskPairs[taskPairStart[t]] .. taskPairStart[t + 1]
  std::vector<ActiveSetBits> mask;                         ///< active set of each of these in the factors
  std::vector<std::array<std::array<double, 3>, 3>> axes;  ///< frames of the blocks at assembly, [node][axis][component]
  std::vector<BlockClass> blockClasses;                    ///< of the island's blocks; may include classes that have left it
  std::vector<std::int32_t> blockClassOf;                  ///< of each node
  double jacobianStep_s = 0.0;                             ///< step for which the own matrices were computed
  AlignedVector<ContactTangent> factorTangents;  ///< contributions to the factors of pairs that slipped when they were made
  EliminationOrder order;                        ///< order in which the matrix is laid out
  std::uint64_t members = 0;                     ///< hash of the blocks for which this order was found
  std::size_t orderProducts = 0;                 ///< products of a factorisation at that time
  std::vector<BlockPair> edges;                  ///< nodes that touching pairs couple, as last laid out
};

/// Makes the system of an island that is gone one of an island to come.
inline void reset(NewtonSystem& island) {
  island.pattern = 0;
  island.members = 0;
  island.exceedsFill = false;
  island.factorised = false;
  island.forcesKnown = false;
  island.step_s = 0.0;
  island.jacobianStep_s = 0.0;
  island.blockClassOf.clear();
  island.directions = 0;
  island.changedIterations = 0;
}

/// Whether any point slides.
inline bool anySlides(ActiveSetBits mask) {
  return (mask & kAllPoints * kSlideBit) != 0;
}

/// The active set of a manifold of `count` points that all push and stick.
inline ActiveSetBits allPush(std::size_t count) {
  return static_cast<ActiveSetBits>((1U << count) - 1U);
}

/// The own matrix of a node's block.
inline const BlockJacobian& jacobianOf(const NewtonSystem& island, std::size_t node) {
  return island.blockClasses[static_cast<std::size_t>(island.blockClassOf[node])].jacobian;
}

}  // namespace springtower
