#include "solver/sleep/support_check.h"

#include "core/tuning.h"
#include "solver/contact/query.h"
#include "solver/sleep/support_solver.h"

#include <algorithm>
#include <cmath>

namespace springtower {

namespace {

double heightOf(const Simulation& simulation, std::int32_t block, const Vec3& up) {
  return centre(simulation.state.position, static_cast<std::size_t>(block)).dot(up);
}

// Lists the pairs of each sleeping block.
void listPairsOfSleepers(Simulation& simulation) {
  Engine& engine = *simulation.engine;
  SupportCheckScratch& check = engine.scratch.support;
  const auto forEach = [&](const auto& visit) {
    for (std::size_t p = 0; p < engine.pairs.size(); ++p) {
      if (!engine.pairs.touches(p)) continue;
      const BlockPair& pair = engine.pairs.key[p];
      if (isSleeper(simulation, pair.a)) visit(static_cast<std::size_t>(pair.a), p);
      if (isSleeper(simulation, pair.b)) visit(static_cast<std::size_t>(pair.b), p);
    }
  };
  check.start.assign(simulation.asleep.size() + 1, 0);
  forEach([&](std::size_t b, std::size_t) { ++check.start[b + 1]; });
  for (std::size_t b = 0; b < simulation.asleep.size(); ++b) check.start[b + 1] += check.start[b];
  check.pairs.resize(static_cast<std::size_t>(check.start.back()));
  engine.scratch.cursor.assign(check.start.begin(), check.start.end());
  forEach([&](std::size_t b, std::size_t p) {
    check.pairs[static_cast<std::size_t>(engine.scratch.cursor[b]++)] = static_cast<std::int32_t>(p);
  });
}

template <typename Visit>
void forEachPair(const Engine& engine, std::int32_t block, const Visit& visit) {
  const SupportCheckScratch& check = engine.scratch.support;
  const auto b = static_cast<std::size_t>(block);
  for (auto k = static_cast<std::size_t>(check.start[b]); k < static_cast<std::size_t>(check.start[b + 1]); ++k) {
    visit(check.pairs[k], engine.pairs.key[static_cast<std::size_t>(check.pairs[k])]);
  }
}

// Lists the sleeping blocks connected by contacts to those with a changed load, from the top down. Converts load changes to
// torques about the origin, multiplied by the safety factor.
void listSleepers(Simulation& simulation, const Vec3& up) {
  Engine& engine = *simulation.engine;
  SupportCheckScratch& check = engine.scratch.support;
  check.blocks.assign(engine.scratch.pushed.begin(), engine.scratch.pushed.end());
  for (const std::int32_t block : check.blocks) {
    LoadChange& change = engine.scratch.loadChange[static_cast<std::size_t>(block)];
    change.torque = tuning::kSupportSafetyFactor *
                    (change.torque + centre(simulation.state.position, static_cast<std::size_t>(block)).cross(change.force));
    change.force *= tuning::kSupportSafetyFactor;
  }
  for (std::size_t i = 0; i < check.blocks.size(); ++i) {
    const std::int32_t block = check.blocks[i];
    forEachPair(engine, block, [&](std::int32_t, const BlockPair& pair) {
      const std::int32_t other = pair.a == block ? pair.b : pair.a;
      if (!isSleeper(simulation, other) || engine.scratch.joined[static_cast<std::size_t>(other)] != 0) return;
      engine.scratch.joined[static_cast<std::size_t>(other)] = 1;
      engine.scratch.loadChange[static_cast<std::size_t>(other)] = {};
      check.blocks.push_back(other);
    });
  }
  std::sort(check.blocks.begin(), check.blocks.end(), [&](std::int32_t a, std::int32_t b) {
    const double heightA = heightOf(simulation, a, up);
    const double heightB = heightOf(simulation, b, up);
    return heightA != heightB ? heightA > heightB : a < b;
  });
}

// Whether one sleeping block of a pair supports the other; blocks that only lean on one another or lie side by side are not
// joined.
bool isVertical(const SleepLoad& load, const Vec3& up) {
  return std::abs(load.force.dot(up)) > tuning::kSupportCosine * load.force.norm();
}

// Adds a sleeping block to the groups above the level: joins it with those that it supports, and adds its pairs below to the open
// ones.
void addToGroups(Simulation& simulation, std::int32_t block, const Vec3& up) {
  Engine& engine = *simulation.engine;
  SupportCheckScratch& check = engine.scratch.support;
  check.parent[static_cast<std::size_t>(block)] = block;
  forEachPair(engine, block, [&](std::int32_t at, const BlockPair& pair) {
    const std::int32_t other = pair.a == block ? pair.b : pair.a;
    if (other < 0 || check.parent[static_cast<std::size_t>(other)] < 0) {
      check.open.push_back(at);
      return;
    }
    if (!isVertical(sleepLoadOf(engine, static_cast<std::size_t>(at)), up)) return;
    const std::int32_t into = findRoot(check.parent, block);
    const std::int32_t from = findRoot(check.parent, other);
    if (into == from) return;
    check.parent[static_cast<std::size_t>(from)] = into;
    LoadChange& sum = engine.scratch.loadChange[static_cast<std::size_t>(into)];
    sum.force += engine.scratch.loadChange[static_cast<std::size_t>(from)].force;
    sum.torque += engine.scratch.loadChange[static_cast<std::size_t>(from)].torque;
  });
}

bool isAbove(const SupportCheckScratch& check, std::int32_t block) {
  return block >= 0 && check.parent[static_cast<std::size_t>(block)] >= 0;
}

// Lists the groups above the level with a changed load, and the pairs that may support each, group by group.
void listPushedGroups(Simulation& simulation) {
  Engine& engine = *simulation.engine;
  SupportCheckScratch& check = engine.scratch.support;
  check.groups.clear();
  for (const std::int32_t block : engine.scratch.pushed) {
    if (isAbove(check, block)) check.groups.push_back(findRoot(check.parent, block));
  }
  std::sort(check.groups.begin(), check.groups.end());
  check.groups.erase(std::unique(check.groups.begin(), check.groups.end()), check.groups.end());
  check.beneath.clear();
  for (const std::int32_t at : check.open) {
    const BlockPair& pair = engine.pairs.key[static_cast<std::size_t>(at)];
    const std::int32_t group = findRoot(check.parent, isAbove(check, pair.a) ? pair.a : pair.b);
    if (std::binary_search(check.groups.begin(), check.groups.end(), group)) check.beneath.push_back({group, at});
  }
  std::sort(check.beneath.begin(), check.beneath.end());
}

// The points that support a group above the level, relative to their middle, which is returned.
Vec3 findSupports(Simulation& simulation, std::span<const SupportPair> beneath, const Vec3& up) {
  SupportCheckScratch& check = simulation.engine->scratch.support;
  check.supports.clear();
  Vec3 middle = Vec3::Zero();
  for (const SupportPair& of : beneath) {
    const BlockPair& pair = simulation.engine->pairs.key[static_cast<std::size_t>(of.pair)];
    const ContactView contact = contactOf(*simulation.engine, static_cast<std::size_t>(of.pair));
    const std::int32_t above = isAbove(check, pair.a) ? pair.a : pair.b;
    const PointForces points = forcesNow(simulation, contact);
    const double sense = contact.upper == above ? 1.0 : -1.0;
    if (!(sense * points.direction.dot(up) > tuning::kSupportCosine)) continue;
    const bool awake = !sleeps(simulation, pair.a == above ? pair.b : pair.a);
    const Friction coefficients = simulation.friction.of(pair.a, pair.b);
    for (std::size_t i = 0; i < static_cast<std::size_t>(contact.count); ++i) {
      if (!(points.normal[i] > 0.0)) continue;
      const Vec3 friction{points.friction[i][0], points.friction[i][1], points.friction[i][2]};
      SupportPoint point;
      point.arm = points.place[i];
      point.normal = sense * points.direction;
      point.force = sense * (points.normal[i] * points.direction + friction);
      point.friction = coefficients.staticFriction;
      if (awake && friction.norm() > tuning::kAwakeSlidingShare * coefficients.kineticFriction * points.normal[i]) {
        point.state = SupportState::slip;
        point.slide = sense * friction;
        point.friction = coefficients.kineticFriction;
      }
      check.supports.push_back(point);
      middle += point.arm;
    }
  }
  if (!check.supports.empty()) middle /= static_cast<double>(check.supports.size());
  for (SupportPoint& point : check.supports) point.arm -= middle;
  return middle;
}

// Whether the supports of a group above the level can hold it.
bool supportHolds(Simulation& simulation, std::int32_t group, std::span<const SupportPair> beneath, const Vec3& up) {
  const LoadChange& change = simulation.engine->scratch.loadChange[static_cast<std::size_t>(group)];
  std::vector<SupportPoint>& supports = simulation.engine->scratch.support.supports;
  const double height = simulation.lengths.blockHeight_m;
  const Vec3 middle = findSupports(simulation, beneath, up);
  if (supports.empty()) return true;  // supported only by awake blocks above this level: checked there
  const Vec3 torque = change.torque - middle.cross(change.force);
  double supportForce = 0.0;
  for (const SupportPoint& point : supports) supportForce += point.normal.dot(point.force);
  if (change.force.norm() <= tuning::kMinGroupLoadChange * supportForce &&
      torque.norm() <= tuning::kMinGroupLoadChange * supportForce * height)
    return true;
  return redistribute(supports, change.force, torque, height, simulation.scene.settings.tangentialRatio);
}

// Whether nearly the same loads were checked last, with the result that all blocks stay; if not, stores the present ones.
bool isAlreadyChecked(Simulation& simulation) {
  Engine& engine = *simulation.engine;
  std::vector<CheckedLoad>& known = engine.sleep.checkedLoads;
  const bool same = std::equal(known.begin(), known.end(), engine.scratch.pushed.begin(), engine.scratch.pushed.end(),
                               [&](const CheckedLoad& before, std::int32_t block) {
                                 const auto b = static_cast<std::size_t>(block);
                                 const LoadChange& now = engine.scratch.loadChange[b];
                                 const double most = tuning::kRepeatLoadChange * now.load_n;
                                 return before.block == block && (now.force - before.force).norm() <= most &&
                                        (now.torque - before.torque).norm() <= most * simulation.model.dimensions[b].minCoeff();
                               });
  if (same) return true;
  known.clear();
  for (const std::int32_t block : engine.scratch.pushed) {
    const LoadChange& now = engine.scratch.loadChange[static_cast<std::size_t>(block)];
    known.push_back({block, now.force, now.torque});
  }
  return false;
}

}  // namespace

bool findFailedSupports(Simulation& simulation) {
  Engine& engine = *simulation.engine;
  SupportCheckScratch& check = engine.scratch.support;
  if (engine.sleep.gravity.isZero(0.0) || isAlreadyChecked(simulation)) return false;
  const Vec3 up = -engine.sleep.gravity.normalized();
  listPairsOfSleepers(simulation);
  listSleepers(simulation, up);
  check.parent.assign(simulation.asleep.size(), -1);
  check.open.clear();
  bool failed = false;
  std::size_t above = 0;  // number of blocks above the level
  while (above < check.blocks.size()) {
    const double level = heightOf(simulation, check.blocks[above], up) - tuning::kLevelHeight * simulation.lengths.blockHeight_m;
    for (; above < check.blocks.size() && heightOf(simulation, check.blocks[above], up) > level; ++above) {
      addToGroups(simulation, check.blocks[above], up);
    }
    const auto isOver = [&](std::int32_t block) {
      return !isFixed(simulation, block) && heightOf(simulation, block, up) > level;
    };
    std::erase_if(check.open, [&](std::int32_t at) {
      const BlockPair& pair = engine.pairs.key[static_cast<std::size_t>(at)];
      return isOver(pair.a) && isOver(pair.b);
    });
    listPushedGroups(simulation);
    const auto beneathOf = [&](std::int32_t group) {
      const auto first = std::lower_bound(check.beneath.begin(), check.beneath.end(), SupportPair{group, 0});
      const auto last = std::lower_bound(first, check.beneath.end(), SupportPair{group + 1, 0});
      return std::span<const SupportPair>(first, last);
    };
    for (const std::int32_t group : check.groups) {
      if (supportHolds(simulation, group, beneathOf(group), up)) continue;
      failed = true;
      engine.sleep.checkedLoads.clear();
      for (std::size_t i = 0; i < above; ++i) {
        if (findRoot(check.parent, check.blocks[i]) == group)
          engine.scratch.toWake.push_back({check.blocks[i], WakeReason::failedSupport});
      }
    }
  }
  return failed;
}

}  // namespace springtower
