#include "apps/viewer/session/game.h"

#include "apps/viewer/session/footprint.h"
#include "core/tuning.h"
#include "scenarios/recorded/recording.h"
#include "solver/block/inertia.h"
#include "solver/statics/loose.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <numeric>
#include <string_view>

namespace springtower {
namespace {

constexpr double kRowSlack = 1.0 / 3.0;   // of a block's height, that a block in a row may be off its height
constexpr double kFlat = 0.95;            // least vertical part of the axis that points up
constexpr double kFloorSlack = 0.02;      // of a block's height, above the floor
constexpr double kQuietSpeed_m_s = 5e-3;  // of any corner, while a turn ends
constexpr double kQuietTime_s = 0.5;      // how long it has to last
constexpr double kOver = 0.25;            // of a block's height: how far into its top one may reach that lies over it

double heightOf(const Simulation& simulation, std::size_t block) {
  return simulation.model.dimensions[block].z();
}

double lowestCorner(const ParticleArray& position, std::size_t block) {
  const double* z = position.values(2, block);
  return *std::min_element(z, z + kCorners);
}

bool touchesFloor(const Simulation& simulation, std::size_t block) {
  return lowestCorner(simulation.state.position, block) < kFloorSlack * heightOf(simulation, block);
}

double meanHeight(const Simulation& simulation) {
  double sum = 0.0;
  for (const Vec3& dimensions : simulation.model.dimensions) sum += dimensions.z();
  return sum / static_cast<double>(simulation.model.blockCount());
}

void beginTurn(Game& game, const Simulation& simulation, std::uint64_t frame) {
  const std::size_t blocks = simulation.model.blockCount();
  game.phase = Phase::choose;
  game.block = kFloor;
  game.held = kFloor;
  game.quiet_s = 0.0;
  game.turnFrame = frame;
  game.turnCentre.resize(blocks);
  game.turnRow.resize(blocks);
  std::vector<int> count;
  for (std::size_t b = 0; b < blocks; ++b) {
    game.turnCentre[b] = centre(simulation.state.position, b);
    game.turnRow[b] = rowOf(simulation, b);
    if (game.turnRow[b] < 0) continue;
    const auto row = static_cast<std::size_t>(game.turnRow[b]);
    if (row >= count.size()) count.resize(row + 1);
    ++count[row];
  }
  game.topRow = -1;
  for (std::size_t row = 0; row < count.size(); ++row) {
    if (count[row] >= 3) game.topRow = static_cast<int>(row);
  }
}

// Whether a block lies over this one, on it or with a gap of less than half its height.
bool isCovered(std::span<const Footprint> all, std::size_t block) {
  const Footprint& own = all[block];
  const double height = own.top_m - own.bottom_m;
  for (std::size_t b = 0; b < all.size(); ++b) {
    const double above = all[b].bottom_m - own.top_m;
    if (b == block || above < -kOver * height || above > 0.5 * height) continue;
    if (overlapOf(all[b], own) > tuning::kMinOutlineOverlap_m) return true;
  }
  return false;
}

bool quiet(const Simulation& simulation) {
  for (std::size_t b = 0; b < simulation.model.blockCount(); ++b) {
    if (simulation.asleep[b] == 0 && rigidMotion(simulation.state, b).cornerSpeed > kQuietSpeed_m_s) return false;
  }
  return true;
}

std::string counted(int number, std::string_view noun) {
  return fmt::format("{} {}{}", number, noun, number == 1 ? "" : "s");
}

}  // namespace

int rowOf(const Simulation& simulation, std::size_t block) {
  const Vec3 up = meanEdge(simulation.state.position, block, 2);
  const double height = meanHeight(simulation);
  const double level = centre(simulation.state.position, block).z() / height - 0.5;
  const double row = std::round(level);
  const bool flat = std::abs(up.z()) > kFlat * up.norm();
  return flat && std::abs(level - row) < kRowSlack && row >= 0.0 ? static_cast<int>(row) : -1;
}

Game newGame(const Simulation& simulation, int players, std::uint64_t frame) {
  Game game;
  game.players = std::clamp(players, 0, kMaxPlayers);
  game.onFloor.resize(simulation.model.blockCount());
  for (std::size_t b = 0; b < game.onFloor.size(); ++b) game.onFloor[b] = touchesFloor(simulation, b) ? 1 : 0;
  beginTurn(game, simulation, frame);
  return game;
}

bool mayTake(const Game& game, BlockId block) {
  if (game.players == 0) return true;
  if (game.phase == Phase::over || block == kFloor) return false;
  if (game.phase == Phase::moving) return block == game.block;
  const int row = game.turnRow[index(block)];
  return row >= 0 && row < game.topRow;
}

bool followGame(Game& game, const Simulation& simulation, BlockId held, std::uint64_t frame) {
  if (game.players == 0 || game.phase == Phase::over) return false;
  if (held != kFloor) game.held = held;
  if (game.phase == Phase::choose && held != kFloor) {
    const std::size_t b = index(held);
    const double moved = (centre(simulation.state.position, b) - game.turnCentre[b]).norm();
    if (moved > 0.5 * simulation.model.dimensions[b].y()) {
      game.phase = Phase::moving;
      game.block = held;
    }
  }
  for (std::size_t b = 0; b < simulation.model.blockCount(); ++b) {
    const bool moving = blockId(b) == game.block || (game.phase == Phase::choose && blockId(b) == held);
    if (moving || game.onFloor[b] != 0 || !touchesFloor(simulation, b)) continue;
    game.phase = Phase::over;
    game.fallen = blockId(b);
    // Until the next player touches a block, the tower falls by the one laid last.
    if (game.held == kFloor && game.laid != kFloor) game.player = (game.player + game.players - 1) % game.players;
    return false;
  }
  if (game.phase != Phase::moving) return false;
  const bool onTop = held == kFloor && rowOf(simulation, index(game.block)) > game.topRow;
  game.quiet_s = onTop && quiet(simulation) ? game.quiet_s + simulation.scene.settings.frame_s : 0.0;
  if (game.quiet_s < kQuietTime_s) return false;
  ++game.moves;
  game.laid = game.block;
  game.player = (game.player + 1) % game.players;
  game.onFloor[index(game.block)] = 0;
  beginTurn(game, simulation, frame);
  return true;
}

std::string describe(const Game& game) {
  if (game.players == 0) return "No game: take any block.";
  const std::string who = game.players == 1 ? fmt::format("{} laid on top.", counted(game.moves, "block"))
                                            : fmt::format("Player {}:", game.player + 1);
  const std::string verb = game.players == 1 ? "Take" : "take";
  switch (game.phase) {
    case Phase::choose:
      if (game.topRow < 1) return fmt::format("{} there is no block below a full row.", who);
      return fmt::format("{} {} a block from the lowest {} rows.", who, verb, game.topRow);
    case Phase::moving:
      return game.players == 1 ? fmt::format("{} Lay block {} on top.", who, index(game.block))
                               : fmt::format("{} lay block {} on top.", who, index(game.block));
    case Phase::over:
      if (game.players == 1)
        return fmt::format("It fell after {}: block {} lies below.", counted(game.moves, "move"), index(game.fallen));
      if (causeOf(game) == kFloor) return fmt::format("Nobody loses: block {} fell.", index(game.fallen));
      return fmt::format("Player {} loses after {}: block {} fell.", game.player + 1, counted(game.moves, "move"),
                         index(game.fallen));
  }
  return {};
}

BlockId causeOf(const Game& game) {
  if (game.phase != Phase::over) return kFloor;
  return game.held != kFloor ? game.held : game.laid;
}

std::string causeInWords(const Game& game) {
  if (game.phase != Phase::over) return {};
  const BlockId cause = causeOf(game);
  if (cause == kFloor) return "It fell by itself: nobody had touched a block.";
  const char* const how = game.held == kFloor ? "laid on top" : (game.block == game.held ? "taken out" : "pulled");
  return fmt::format("Block {} did it: it was {} last.", index(cause), how);
}

std::vector<Hint> hints(const Simulation& simulation, std::span<const ContactForce> contacts) {
  const std::size_t blocks = simulation.model.blockCount();
  std::vector<Hint> all(blocks);
  for (std::size_t b = 0; b < blocks; ++b) all[b].block = blockId(b);
  for (const ContactForce& contact : contacts) {
    const double drag = staticFrictionOf(simulation, contact) * contact.normalForce;
    // A contact presses on the face below it from above, whichever of its blocks the engine calls upper.
    const double load = contact.normalForce * contact.normal.z();
    all[index(contact.upper)].drag_n += drag;
    if (load < 0.0) all[index(contact.upper)].load_n -= load;
    if (contact.lower == kFloor) continue;
    all[index(contact.lower)].drag_n += drag;
    if (load > 0.0) all[index(contact.lower)].load_n += load;
  }
  const std::vector<Footprint> footprints = footprintsOf(simulation.state.position);
  const auto& mass = simulation.model.mass;
  const double mean = std::accumulate(mass.begin(), mass.end(), 0.0) / static_cast<double>(blocks);
  for (std::size_t b = 0; b < blocks; ++b) {
    all[b].loose = isLoose(isCovered(footprints, b), all[b].load_n, mean * simulation.scene.gravity.magnitude);
  }
  return all;
}

std::string inWords(const Hint& hint, std::optional<bool> stands) {
  std::string line = fmt::format("{}: {:.1f} N to pull.", hint.loose ? "Loose" : "Tight", hint.drag_n);
  if (stands) line += *stands ? " The tower stands without it." : " The tower falls without it.";
  return line;
}

std::optional<WithoutBlock> withoutBlock(const Simulation& simulation, std::span<const ContactForce> contacts, BlockId block) {
  const Vec3 gravity = simulation.scene.gravity.at(simulation.time_s);
  const std::size_t blocks = simulation.model.blockCount();
  if (gravity.norm() == 0.0 || blocks < 2) return {};
  Scene rest = simulation.scene;
  rest.forces.clear();
  rest.blocks.clear();
  for (std::size_t b = 0; b < blocks; ++b) {
    if (blockId(b) == block) continue;
    BlockSpec& spec = rest.blocks.emplace_back();
    spec.centre = centre(simulation.state.position, b);
    spec.dimensions = simulation.model.dimensions[b];
    spec.orientation = orientationOf(simulation.state.position, b);
    spec.mass = simulation.model.mass[b];
    spec.fixed = simulation.model.isFixed(b);
  }
  const auto renumbered = [&](BlockId b) { return b == kFloor || index(b) < index(block) ? b : blockId(index(b) - 1); };
  std::vector<FacePair> facings;
  for (const ContactForce& contact : contacts) {
    if (block != kFloor && (contact.upper == block || contact.lower == block)) continue;
    facings.push_back({renumbered(contact.upper), renumbered(contact.lower), contact.normal, {{contact.point, 0.0}}});
  }
  return WithoutBlock{staticsModel(rest, facings), gravity.normalized()};
}

std::optional<StabilityMargin> marginOf(const WithoutBlock& question) {
  constexpr double kTolerance_deg = 0.05;
  std::vector<std::size_t> usable(question.model.points.size());
  std::iota(usable.begin(), usable.end(), std::size_t{0});
  return tiltMargin(question.model, usable, question.gravity, kTolerance_deg);
}

double tiltBorne(const WithoutBlock& question) {
  constexpr double kNever_deg = -90.0;
  const std::optional<StabilityMargin> margin = marginOf(question);
  return margin ? margin->tilt_deg : kNever_deg;
}

}  // namespace springtower
