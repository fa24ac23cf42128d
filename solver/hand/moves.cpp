#include "solver/hand/moves.h"

#include "core/rotation_vector.h"
#include "core/tuning.h"
#include "solver/block/inertia.h"
#include "solver/metrics/measures.h"
#include "solver/world/scales.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>
#include <span>

namespace springtower {
namespace {

// Distance of the outer places of a row from its middle.
constexpr double kPitch_m = 0.5 * (kBlockLength_m - kBlockWidth_m);

double timeLimit(const Move& move, const MoveRun& run, const Vec3& size) {
  return tuning::kMaxPhaseTime_s + (run.phase == MovePhase::draw ? 3.0 * size.maxCoeff() / move.speed_m_s : 0.0);
}

void enter(MoveRun& run, MovePhase phase) {
  run.phase = phase;
  run.phase_s = 0.0;
}

// Rows count from the floor: each stands on the highest block of the row below, as in a bit code.
void stack(std::vector<BlockSpec>& blocks) {
  std::vector<std::size_t> order;
  for (std::size_t b = 0; b < blocks.size(); ++b) {
    if (blocks[b].row >= 0) order.push_back(b);
  }
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return blocks[a].row < blocks[b].row; });
  double floor = 0.0;
  double top = 0.0;
  int row = 0;
  for (const std::size_t b : order) {
    if (blocks[b].row != row) floor = top;
    row = blocks[b].row;
    blocks[b].centre.z() = floor + 0.5 * blocks[b].dimensions.z();
    top = std::max(top, floor + blocks[b].dimensions.z());
  }
}

// Static analysis of the blocks that are in the tower now; stable without gravity or blocks.
StaticScene rigidTower(MoveRun& run, const Simulation& simulation) {
  stack(run.rigid);
  Scene scene = simulation.scene;
  scene.moves.clear();
  scene.forces.clear();
  scene.blocks.clear();
  std::copy_if(run.rigid.begin(), run.rigid.end(), std::back_inserter(scene.blocks),
               [](const BlockSpec& block) { return block.row >= 0; });
  if (!scene.blocks.empty() && scene.gravity.magnitude > 0.0) return staticScene(scene);
  StaticScene none;
  none.rest = Rest::stands;
  return none;
}

// Whether all but the held block are at rest, and have been since the phase began.
bool othersRest(const MoveRun& run, const Simulation& simulation) {
  const double needed_s = simulation.scene.settings.sleepTime * restTimeScale_s(simulation);
  if (run.phase_s < needed_s) return false;
  for (std::size_t b = 0; b < simulation.restTime_s.size(); ++b) {
    if (blockId(b) != run.draw.hand.block && simulation.restTime_s[b] < needed_s) return false;
  }
  return true;
}

// Height of the highest block within an outline, excluding one block.
double topBelow(const Simulation& simulation, BlockId except, const Vec3& middle, const Vec3& half) {
  double top = 0.0;
  for (std::size_t b = 0; b < simulation.model.blockCount(); ++b) {
    if (blockId(b) == except) continue;
    Vec3 least = simulation.state.position.at(b, 0);
    Vec3 most = least;
    for (std::size_t c = 1; c < kCorners; ++c) {
      least = least.cwiseMin(simulation.state.position.at(b, c));
      most = most.cwiseMax(simulation.state.position.at(b, c));
    }
    const bool over = (most - (middle - half)).head<2>().minCoeff() > tuning::kMinOutlineOverlap_m &&
                      (middle + half - least).head<2>().minCoeff() > tuning::kMinOutlineOverlap_m;
    if (over) top = std::max(top, most.z());
  }
  return top;
}

// State of the row on which a block is to be placed: its upward direction, and its horizontal displacement from its nominal
// place.
struct Ground {
  Vec3 up = Vec3::UnitZ();
  Vec3 shift = Vec3::Zero();
};

Ground groundOf(const MoveRun& run, const Simulation& simulation, int row) {
  Vec3 up = Vec3::Zero();
  Vec3 shift = Vec3::Zero();
  int count = 0;
  for (std::size_t b = 0; b < run.rigid.size(); ++b) {
    if (run.rigid[b].row != row) continue;
    const Vec3 edge = meanEdge(simulation.state.position, b, 2).normalized();
    up += edge.z() < 0.0 ? Vec3(-edge) : edge;
    shift += centre(simulation.state.position, b) - run.rigid[b].centre;
    ++count;
  }
  if (count == 0) return {};
  return {up.normalized(), Vec3(shift.x() / count, shift.y() / count, 0.0)};
}

// Moves the goal along the row, away from neighbours in the way: to the middle between two if there is not enough room.
void makeRoom(MoveRun& run, const Simulation& simulation, const Move& move, const Vec3& half) {
  const Eigen::Index along = move.row % 2 != 0 ? 0 : 1;
  double least = -1e300;
  double most = 1e300;
  for (std::size_t b = 0; b < run.rigid.size(); ++b) {
    if (run.rigid[b].row != move.row) continue;
    for (std::size_t c = 0; c < kCorners; ++c) {
      const double at = simulation.state.position.at(b, c)[along];
      if (run.rigid[b].position < move.position) least = std::max(least, at + half[along] + tuning::kPlaceGap_m);
      if (run.rigid[b].position > move.position) most = std::min(most, at - half[along] - tuning::kPlaceGap_m);
    }
  }
  double& goal = run.goal[along];
  goal = least > most ? 0.5 * (least + most) : std::clamp(goal, least, most);
}

// Sets the goal of a block, flat on the row below, and its orientation there: the nearer of two.
void aim(MoveRun& run, const Simulation& simulation, const Move& move) {
  const std::size_t b = index(run.now.block);
  const Vec3 size = simulation.model.dimensions[b];
  const Eigen::Quaterniond turn = orientationOf(simulation.state.position, b);
  Vec3 half = 0.5 * size;
  double angle = 0.0;
  Ground ground;
  if (move.kind == MoveKind::putAside) {
    const auto count = static_cast<double>(std::count(run.leftOut.begin(), run.leftOut.end(), 1) - 1);
    run.goal = {tuning::kAsideDistance_m, tuning::kAsideSpacing_m * count, 0.0};
  } else {
    const bool across = move.row % 2 != 0;
    const double off = (move.position - 2) * kPitch_m;
    ground = groundOf(run, simulation, move.row - 1);
    run.place = across ? Vec3(off, 0.0, 0.0) : Vec3(0.0, off, 0.0);
    run.goal = run.place + ground.shift;
    if (across) angle = 0.5 * std::numbers::pi;
    if (across) std::swap(half.x(), half.y());
  }
  run.placeTurn = rotationAbout(Vec3::UnitZ(), angle);
  const Eigen::Quaterniond other = rotationAbout(Vec3::UnitZ(), angle + std::numbers::pi);
  if (std::abs(other.dot(turn)) > std::abs(run.placeTurn.dot(turn))) run.placeTurn = other;
  run.goalTurn = Eigen::Quaterniond::FromTwoVectors(Vec3::UnitZ(), ground.up) * run.placeTurn;
  if (move.kind == MoveKind::put) makeRoom(run, simulation, move, half);
  run.goal.z() = topBelow(simulation, run.now.block, run.goal, half) + 0.5 * size.z() + move.drop_m;
}

// Moves the hand in a straight line towards a goal; returns whether it has arrived.
bool moveTowards(Hand& hand, const Vec3& goal, double speed_m_s, double frame_s) {
  const Vec3 way = goal - hand.place;
  const double step = speed_m_s * frame_s;
  const Vec3 next = way.norm() > step ? Vec3(hand.place + way * (step / way.norm())) : goal;
  hand.velocity = (next - hand.place) / frame_s;
  hand.place = next;
  return way.norm() <= step;
}

bool isThere(const Simulation& simulation, BlockId block, const Vec3& goal) {
  const RigidMotion motion = rigidMotion(simulation.state, index(block));
  return (motion.centre - goal).norm() < tuning::kGoalDistance_m && motion.velocity.norm() < tuning::kGoalSpeed_m_s;
}

// Whether a block touches another; the floor does not keep it in the tower.
bool touchesBlocks(std::span<const ContactForce> contacts, BlockId block) {
  return std::any_of(contacts.begin(), contacts.end(), [&](const ContactForce& contact) {
    return contact.lower != kFloor && (contact.upper == block || contact.lower == block) && contact.normalForce > 0.0;
  });
}

// Extent of a block along a direction.
double extentAlong(const Simulation& simulation, std::size_t block, const Vec3& direction) {
  double least = 1e300;
  double most = -1e300;
  for (std::size_t c = 0; c < kCorners; ++c) {
    const double along = simulation.state.position.at(block, c).dot(direction);
    least = std::min(least, along);
    most = std::max(most, along);
  }
  return most - least;
}

// The side of a block nearest to a direction: a hand draws a block parallel to its faces, however its row leans.
Vec3 alongBlock(const Simulation& simulation, std::size_t block, const Vec3& direction) {
  Vec3 best = direction;
  double most = 0.0;
  for (std::size_t a = 0; a < 3; ++a) {
    const Vec3 side = meanEdge(simulation.state.position, block, a).normalized();
    const double along = side.dot(direction);
    if (std::abs(along) <= most) continue;
    most = std::abs(along);
    best = along < 0.0 ? Vec3(-side) : side;
  }
  return best;
}

void begin(MoveRun& run, const Simulation& simulation) {
  const Move& move = simulation.scene.moves[run.results.size()];
  const BlockId held = run.draw.hand.block;
  run.now = {};
  run.now.block = held;
  run.now.begin_s = simulation.time_s;
  run.now.each_m.assign(run.leftOut.size(), 0.0);
  run.before = simulation.state.position;
  if (move.kind != MoveKind::take) {
    aim(run, simulation, move);
    enter(run, MovePhase::lift);
    return;
  }
  std::size_t b = 0;
  while (run.rigid[b].row != move.row || run.rigid[b].position != move.position) ++b;
  run.now.block = blockId(b);
  run.leftOut[b] = 1;
  run.rigid[b].row = -1;
  run.draw = drawingFrom(simulation, blockId(b), alongBlock(simulation, b, move.towards), move.speed_m_s, move.limit_n);
  enter(run, MovePhase::draw);
}

void end(MoveRun& run, const Simulation& simulation, bool done, bool rested) {
  const Move& move = simulation.scene.moves[run.results.size()];
  const std::size_t b = index(run.now.block);
  run.now.rested = rested;
  run.now.end_s = simulation.time_s;
  const Vec3 middle = centre(simulation.state.position, b);
  const bool fellOff =
      move.kind == MoveKind::put &&
      middle.z() < run.goal.z() - move.drop_m - kFallDropInLeastSides * simulation.model.dimensions[b].minCoeff();
  done = done && !fellOff;
  run.now.done = done;
  if (done && move.kind != MoveKind::take) {
    run.now.slide_m = (middle - run.release).head<2>().norm();
    run.draw.hand.block = kFloor;
  }
  if (done && move.kind == MoveKind::put) {
    BlockSpec& rigid = run.rigid[b];
    rigid.row = move.row;
    rigid.position = move.position;
    rigid.centre = run.place;
    rigid.orientation = run.placeTurn;
    run.leftOut[b] = 0;
    run.laid.push_back(b);
  }
  for (std::size_t other = 0; other < run.leftOut.size(); ++other) {
    if (other == b || run.leftOut[other] != 0) continue;
    run.now.each_m[other] = (centre(simulation.state.position, other) - centre(run.before, other)).norm();
    if (run.now.each_m[other] > run.now.moved_m) {
      run.now.moved_m = run.now.each_m[other];
      run.now.moved = blockId(other);
    }
  }
  const StaticScene statics = rigidTower(run, simulation);
  run.now.statics = statics.rest;
  run.now.settlement_m = std::max(0.0, statics.settlement_m - run.settled_m);
  run.settled_m = statics.settlement_m;
  run.results.push_back(run.now);
  run.finished = !done || run.results.size() == simulation.scene.moves.size();
  if (!run.finished) begin(run, simulation);
}

// Ends the phase and starts the next one when its condition is met; otherwise moves the hand.
void follow(MoveRun& run, const Simulation& simulation, std::span<const ContactForce> contacts) {
  const Move& move = simulation.scene.moves[run.results.size()];
  const double frame_s = simulation.scene.settings.frame_s;
  const std::size_t b = index(run.now.block);
  Hand& hand = run.draw.hand;
  hand.velocity = Vec3::Zero();
  switch (run.phase) {
    case MovePhase::settle:
      break;
    case MovePhase::draw: {
      const double moved = (centre(simulation.state.position, b) - centre(run.before, b)).dot(hand.line);
      if (moved < extentAlong(simulation, b, hand.line) + tuning::kDrawClearance_m || touchesBlocks(contacts, hand.block)) break;
      hand.line = Vec3::Zero();
      enter(run, MovePhase::lift);
      break;
    }
    case MovePhase::lift: {
      const double top =
          topBelow(simulation, hand.block, Vec3::Zero(), Vec3::Constant(tuning::kAsideDistance_m - kBlockLength_m));
      const Vec3 over{hand.place.x(), hand.place.y(), top + tuning::kCarryClearance_m + move.drop_m};
      if (!moveTowards(hand, over, tuning::kCarrySpeed_m_s, frame_s) || !isThere(simulation, hand.block, over)) break;
      enter(run, move.kind == MoveKind::take ? MovePhase::rest : MovePhase::carry);
      break;
    }
    case MovePhase::carry: {
      const double left = angleBetween(hand.turn, run.goalTurn);
      hand.turn = left > tuning::kCarryTurnRate_rad_s * frame_s
                      ? orientationBetween(hand.turn, run.goalTurn, tuning::kCarryTurnRate_rad_s * frame_s / left)
                      : run.goalTurn;
      const Vec3 over{run.goal.x(), run.goal.y(), hand.place.z()};
      if (moveTowards(hand, over, tuning::kCarrySpeed_m_s, frame_s) && left <= tuning::kCarryTurnRate_rad_s * frame_s &&
          isThere(simulation, hand.block, over)) {
        enter(run, MovePhase::lower);
      }
      break;
    }
    case MovePhase::lower: {
      const bool drops = move.kind == MoveKind::put && move.drop_m > 0.0;
      const bool last = !drops && hand.place.z() < run.goal.z() + tuning::kPlaceHeight_m;
      const Vec3 below = drops ? run.goal : Vec3(run.goal - tuning::kPlaceHeight_m * Vec3::UnitZ());
      const bool there = moveTowards(hand, below, last ? tuning::kPlaceSpeed_m_s : tuning::kLowerSpeed_m_s, frame_s);
      // A block that bounces may be off the ground at the end of any frame.
      if (!drops && (there || holdOf(contacts, hand.block) != Hold::free)) enter(run, MovePhase::press);
      if (drops && there && isThere(simulation, hand.block, below)) enter(run, MovePhase::still);
      break;
    }
    case MovePhase::press:
    case MovePhase::still:
      if (run.phase_s < (run.phase == MovePhase::press ? tuning::kPressTime_s : tuning::kPreDropTime_s)) break;
      run.release = centre(simulation.state.position, b);
      hand.block = kFloor;
      enter(run, MovePhase::rest);
      break;
    case MovePhase::rest:
      if (othersRest(run, simulation)) end(run, simulation, true, true);
      break;
  }
}

}  // namespace

bool isWithin(const Move& move, const MoveResult& result) {
  return result.done && result.rested && (!move.allowed_m || result.moved_m <= *move.allowed_m + result.settlement_m);
}

MoveRun beginMoves(const Simulation& simulation) {
  MoveRun run;
  run.rigid = simulation.scene.blocks;
  run.leftOut.assign(run.rigid.size(), 0);
  run.finished = simulation.scene.moves.empty();
  if (!run.finished) run.settled_m = rigidTower(run, simulation).settlement_m;
  return run;
}

void guideHand(MoveRun& run, Simulation& simulation) {
  run.now.force_n = std::max(run.now.force_n, gripForce(simulation).force.norm());
  letGo(simulation);
  if (run.finished) return;
  if (run.phase == MovePhase::settle) {
    if (simulation.frame == 0 || !(othersRest(run, simulation) || run.phase_s > tuning::kMaxPhaseTime_s)) {
      run.phase_s += simulation.scene.settings.frame_s;
      return;
    }
    begin(run, simulation);
  }
  const Move& move = simulation.scene.moves[run.results.size()];
  const std::vector<ContactForce> contacts = contactForces(simulation);
  if (run.phase_s > timeLimit(move, run, simulation.model.dimensions[index(run.now.block)])) {
    // At the time limit of the final wait the sequence continues, at rest or not; a move that could not be done ends it.
    end(run, simulation, run.phase == MovePhase::rest, false);
  } else {
    follow(run, simulation, contacts);
  }
  run.phase_s += simulation.scene.settings.frame_s;
  if (run.finished || run.draw.hand.block == kFloor) return;
  if (run.phase == MovePhase::draw) {
    advancePull(run.draw, contacts, simulation);
  } else {
    hold(run.draw.hand, contacts, run.draw.grip, simulation);
  }
}

}  // namespace springtower
