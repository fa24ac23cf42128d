#include "scenarios/recorded/recorded_game.h"
#include "solver/hand/grip.h"
#include "solver/hand/moves.h"
#include "tests/pinned/pinned_scene.h"
#include "tests/solver/hand/take.h"

#include <optional>

namespace springtower {
namespace {

Scene moveBetween(const char* code, const Move& first, const Move& second) {
  Scene scene = bitCodeScene(code);
  scene.moves = {first, second};
  return scene;
}

Scene takeAndLayDown() {
  Move put;
  put.kind = MoveKind::put;
  put.row = 3;
  put.position = 2;
  return moveBetween("(111)-(1L1)-(111)", take(1, 2, Vec3::UnitY()), put);
}

Scene takeAndDrop() {
  Move put;
  put.kind = MoveKind::put;
  put.row = 3;
  put.drop_m = 0.02;
  return moveBetween("(111)-(111)-(111)", take(1, 3, Vec3::UnitX(), 0.4), put);
}

// The tower comes down when its last support on one side is drawn out.
Scene takeTheLastSupport() {
  Move away;
  away.kind = MoveKind::putAside;
  Scene scene = moveBetween("(111)-(110)-(111)", take(1, 2, Vec3::UnitY()), away);
  for (Move& move : scene.moves) move.limit_n = 20.0;
  return scene;
}

Leader scriptedHand() {
  return [run = std::optional<MoveRun>()](Simulation& simulation) mutable {
    if (!run) run = beginMoves(simulation);
    guideHand(*run, simulation);
  };
}

// From a frame on draws a block along its length.
Leader drawingHand(std::uint64_t from, int block) {
  return [=, draw = std::optional<Draw>()](Simulation& simulation) mutable {
    if (simulation.frame < from) return;
    const BlockId held = blockId(static_cast<std::size_t>(block));
    const Vec3 along = simulation.scene.blocks[static_cast<std::size_t>(block)].orientation * Vec3::UnitX();
    if (!draw) draw = drawingFrom(simulation, held, along, 0.04);
    advancePull(*draw, contactForcesOn(simulation, held), simulation);
  };
}

// Lifts a block off the top, swings it aside while turning it, and lets go.
Leader swingingHand() {
  constexpr std::uint64_t kLiftFrames = 20;
  constexpr std::uint64_t kHeldFrames = 50;
  return [hand = std::optional<Hand>(), grip = Grip()](Simulation& simulation) mutable {
    if (simulation.frame >= kHeldFrames) return letGo(simulation);
    if (!hand) hand = handOn(simulation, blockId(simulation.model.blockCount() - 1));
    hand->velocity = simulation.frame < kLiftFrames ? Vec3(0.0, 0.0, 0.2) : Vec3(0.3, 0.1, 0.0);
    hand->place += simulation.scene.settings.frame_s * hand->velocity;
    if (simulation.frame == kLiftFrames) hand->turn = Eigen::Quaterniond(0.9, 0.3, 0.0, 0.1).normalized();
    hold(*hand, contactForcesOn(simulation, hand->block), grip, simulation);
  };
}

// A blow every so many frames, to one block after another.
Leader kicks(std::uint64_t every, const Vec3& velocity_m_s) {
  return [=](Simulation& simulation) {
    if (simulation.frame % every != every / 2) return;
    kick(simulation, simulation.frame / every * 5 % simulation.model.blockCount(), velocity_m_s);
  };
}

// As the hand was led in the recorded game.
Leader recordedHand() {
  return [grip = Grip()](Simulation& simulation) mutable {
    const Hand& hand = recordedGame().frames[simulation.frame].input.hand;
    if (hand.block != kFloor) return hold(hand, contactForces(simulation), grip, simulation);
    grip = {};
    letGo(simulation);
  };
}

// To the last frame that is counted.
int recordedFrames() {
  return static_cast<int>(gameParts().back().last);
}

}  // namespace

std::vector<PinnedScene> pinnedHands() {
  return {
      {"DrawnAwake", 90, [] { return awake(towerScene(6)); }, [] { return drawingHand(20, 10); }},
      {"DrawnAsleep", 300, [] { return towerScene(18); }, [] { return drawingHand(200, 28); }},
      {"SwungAndLetGo", 100, [] { return towerScene(3); }, swingingHand},
      {"KickedTower", 60, [] { return towerScene(6); }, [] { return kicks(20, Vec3(0.3, 0.2, 0.0)); }},
      {"KickedAsleep", 260, [] { return towerScene(3); }, [] { return kicks(230, Vec3(0.05, 0.0, 0.1)); }},
      {"TakeAndLayDown", 400, takeAndLayDown, scriptedHand},
      {"TakeAndDrop", 400, takeAndDrop, scriptedHand},
      {"TakeTheLastSupport", 300, takeTheLastSupport, scriptedHand},
      {"ReportMoves", 1900, [] { return sceneOfFile("moves"); }, scriptedHand},
      {"RecordedGame", recordedFrames(), recordedTower, recordedHand},
  };
}

}  // namespace springtower
