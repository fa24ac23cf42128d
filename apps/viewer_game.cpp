#include "apps/viewer_game.h"

#include "solver/inertia.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>

namespace springtower {
namespace {

constexpr double kRowSlack = 1.0 / 3.0;   // of a block's height, that a block in a row may be off its height
constexpr double kFlat = 0.95;            // least vertical part of the axis that points up
constexpr double kFloorSlack = 0.02;      // of a block's height, above the floor
constexpr double kQuietSpeed_m_s = 5e-3;  // of any corner, while a turn ends
constexpr double kQuietTime_s = 0.5;      // how long it has to last
constexpr double kLooseInWeights = 0.5;   // a loose block carries less than this of its own weight

double heightOf(const Simulation& simulation, std::size_t block) {
  return simulation.model.dimensions[block].z();
}

double lowestCorner(const CornerArray& position, std::size_t block) {
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

bool quiet(const Simulation& simulation) {
  for (std::size_t b = 0; b < simulation.model.blockCount(); ++b) {
    if (simulation.asleep[b] == 0 && rigidMotion(simulation.state, b).cornerSpeed > kQuietSpeed_m_s) return false;
  }
  return true;
}

// How far inside the convex hull of some points a point lies: the distance to the nearest side, negative outside.
double insideHull(std::vector<Eigen::Vector2d> points, const Eigen::Vector2d& point) {
  if (points.empty()) return -std::numeric_limits<double>::infinity();
  std::sort(points.begin(), points.end(),
            [](const auto& a, const auto& b) { return a.x() < b.x() || (a.x() == b.x() && a.y() < b.y()); });
  const auto turn = [](const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c) {
    return (b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x());
  };
  std::vector<Eigen::Vector2d> hull;  // counterclockwise (Andrew's monotone chain)
  const auto extend = [&](const Eigen::Vector2d& next, std::size_t least) {
    while (hull.size() >= least + 2 && turn(hull[hull.size() - 2], hull.back(), next) <= 0.0) hull.pop_back();
    hull.push_back(next);
  };
  for (const auto& next : points) extend(next, 0);
  const std::size_t lower = hull.size() - 1;
  for (auto next = points.rbegin() + 1; next != points.rend(); ++next) extend(*next, lower);
  if (hull.size() < 3) return -(points.front() - point).norm();
  double margin = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i + 1 < hull.size(); ++i) {
    const double length = (hull[i + 1] - hull[i]).norm();
    if (length > 0.0) margin = std::min(margin, turn(hull[i], hull[i + 1], point) / length);
  }
  return margin;
}

// The margin of the weight above a row on the row's contacts, without one block of that row.
double marginWithout(const Simulation& simulation, std::span<const ContactForce> contacts, std::span<const int> rows,
                     std::size_t removed) {
  const int row = rows[removed];
  Vec3 moment = Vec3::Zero();
  double mass = 0.0;
  for (std::size_t b = 0; b < rows.size(); ++b) {
    if (rows[b] <= row) continue;
    moment += simulation.model.mass[b] * centre(simulation.state.position, b);
    mass += simulation.model.mass[b];
  }
  if (mass == 0.0) return std::numeric_limits<double>::infinity();
  std::vector<Eigen::Vector2d> carrying;
  for (const ContactForce& contact : contacts) {
    if (contact.lower == kFloor || contact.upper == kFloor) continue;
    std::size_t above = index(contact.upper);
    std::size_t below = index(contact.lower);
    if (rows[above] < rows[below]) std::swap(above, below);
    const bool carries = rows[below] == row && rows[above] > row && below != removed && std::abs(contact.normal.z()) > kFlat;
    if (carries) carrying.emplace_back(contact.point.head<2>());
  }
  return insideHull(std::move(carrying), (moment / mass).head<2>());
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
  game.players = std::clamp(players, 0, kMostPlayers);
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
    return false;
  }
  if (game.phase != Phase::moving) return false;
  const bool onTop = held == kFloor && rowOf(simulation, index(game.block)) > game.topRow;
  game.quiet_s = onTop && quiet(simulation) ? game.quiet_s + simulation.scene.settings.frame_s : 0.0;
  if (game.quiet_s < kQuietTime_s) return false;
  ++game.moves;
  game.player = (game.player + 1) % game.players;
  game.onFloor[index(game.block)] = 0;
  beginTurn(game, simulation, frame);
  return true;
}

std::string describe(const Game& game) {
  if (game.players == 0) return "no game: take any block";
  const int player = game.player + 1;
  switch (game.phase) {
    case Phase::choose:
      if (game.topRow < 1) return fmt::format("player {}: there is no block below a complete row", player);
      return fmt::format("player {}: draw a block from the lowest {} rows", player, game.topRow);
    case Phase::moving:
      return fmt::format("player {}: lay block {} on top", player, index(game.block));
    case Phase::over:
      return fmt::format("player {} loses after {} moves: block {} fell", player, game.moves, index(game.fallen));
  }
  return {};
}

std::vector<Hint> hints(const Simulation& simulation, std::span<const ContactForce> contacts) {
  const std::size_t blocks = simulation.model.blockCount();
  std::vector<Hint> all(blocks);
  std::vector<int> rows(blocks);
  for (std::size_t b = 0; b < blocks; ++b) {
    all[b].block = blockId(b);
    rows[b] = rowOf(simulation, b);
  }
  for (const ContactForce& contact : contacts) {
    const double drag = simulation.scene.staticFriction * contact.normalForce;
    // A contact presses on the face below it from above, whichever of its blocks the engine calls upper.
    const double load = contact.normalForce * contact.normal.z();
    all[index(contact.upper)].drag_n += drag;
    if (load < 0.0) all[index(contact.upper)].load_n -= load;
    if (contact.lower == kFloor) continue;
    all[index(contact.lower)].drag_n += drag;
    if (load > 0.0) all[index(contact.lower)].load_n += load;
  }
  const double gravity = simulation.scene.gravity.magnitude;
  for (std::size_t b = 0; b < blocks; ++b) {
    all[b].loose = all[b].load_n < kLooseInWeights * simulation.model.mass[b] * gravity;
    all[b].margin_m = rows[b] < 0 ? 0.0 : marginWithout(simulation, contacts, rows, b);
  }
  return all;
}

}  // namespace springtower
