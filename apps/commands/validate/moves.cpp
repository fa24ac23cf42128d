#include "apps/commands/run/moves_report.h"
#include "apps/commands/validate/frames.h"
#include "apps/commands/validate/removals.h"
#include "apps/commands/validate/validate.h"
#include "core/random.h"
#include "solver/statics/statics.h"

#include <algorithm>
#include <fmt/format.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>
#include <optional>

namespace springtower {
namespace {

constexpr double kLongest_s = 600.0;
constexpr double kStrongHand_n = 20.0;  // a block under the whole tower has to come as well
// A block is jerked out where its friction force is above this share of the tipping force of the tower: a slow pull, or one at
// 0.4 m/s, tips such towers over, and statics alone does not show it.
constexpr double kSlowShare = 2.0 / 3.0;
constexpr double kJerk_m_s = 1.5;
constexpr std::size_t kShortRemovals = 3;  // of the first sequence

struct Played {
  RunResult result;
  std::vector<Vec3> places;  // m, centres of all blocks in the end
};

Played play(const Scene& scene) {
  RunOptions options;
  options.seconds = kLongest_s;
  options.measureEveryFrame = false;
  Simulation simulation(scene);
  Played played{runSceneOrEnd(simulation, options), {}};
  for (std::size_t b = 0; b < scene.blocks.size(); ++b) played.places.push_back(centre(simulation.state.position, b));
  return played;
}

// Heights that differ by all of the 0.02 mm within which blocks that are not loose count as equal, m, standard deviation.
constexpr double kUnequalHeightsSigma_m = 3.3e-6;
// How far places in the end may be apart with sleep and without, m.
constexpr double kSamePlace_m = 1e-4;
// By up to how much each block is higher or lower in a sequence that shows how much the places in the end depend on that, m: a
// hundredth of the tolerance.
constexpr double kScatterHeight_m = 1e-7;
constexpr std::size_t kScatterDraws = 3;     // of each sequence
constexpr std::uint64_t kScatterStream = 2;  // of random numbers, the first: a tower's heights and masses have 0 and 1

// The report's sequence, played once a seed.
struct PlayedSequence {
  std::vector<Move> moves;
  std::vector<Played> seeds;
};

// What of the sequence is not as in its file.
struct SequenceChange {
  Sleep sleep = Sleep::on;
  std::optional<double> heightsSigma_m = std::nullopt;
  std::optional<std::size_t> scatterDraw = std::nullopt;  // heights are scattered by kScatterHeight_m
};

PlayedSequence playSequence(const ValidationPlan& plan, const SequenceChange& change) {
  const std::size_t seeds = plan.longForm ? 10 : 1;
  std::vector<Scene> scenes;
  for (std::size_t seed = 1; seed <= seeds; ++seed) {
    TowerOptions options;
    options.seed = seed;
    options.heightsSigma_m = change.heightsSigma_m;
    scenes.push_back(sceneFromName(plan.scenes + "/moves.toml", options));
    scenes.back().settings.sleep = change.sleep;
    if (!change.scatterDraw) continue;
    RandomStream random(seed, kScatterStream + *change.scatterDraw);
    for (BlockSpec& block : scenes.back().blocks) block.dimensions.z() += kScatterHeight_m * (2.0 * random.uniform() - 1.0);
  }
  PlayedSequence played{scenes.front().moves, std::vector<Played>(seeds)};
  tbb::parallel_for(std::size_t{0}, seeds,
                    [&](std::size_t i) { tbb::this_task_arena::isolate([&] { played.seeds[i] = play(scenes[i]); }); });
  return played;
}

// How others moved in a step of a sequence: the most over the seeds, and in how many it was within its bound.
struct StepResult {
  std::size_t within = 0;
  double worst_m = 0.0;
  double slide_m = 0.0;
};

StepResult stepOf(const PlayedSequence& played, std::size_t step) {
  StepResult of;
  for (const Played& seed : played.seeds) {
    if (step >= seed.result.moves.size()) continue;
    const MoveResult& move = seed.result.moves[step];
    of.within += isWithin(played.moves[step], move) ? 1 : 0;
    of.worst_m = std::max(of.worst_m, move.moved_m - move.settlement_m);
    of.slide_m = std::max(of.slide_m, move.slide_m);
  }
  return of;
}

// One claim that the sequence comes to its end, and one a step.
void addSequence(const PlayedSequence& played, std::string_view setting, ValidationSection& section) {
  const std::vector<Move>& moves = played.moves;
  const std::size_t seeds = played.seeds.size();
  const auto finished = std::count_if(played.seeds.begin(), played.seeds.end(), [&](const Played& seed) {
    const RunResult& result = seed.result;
    return result.standing.stands && result.moves.size() == moves.size() && result.moves.back().done &&
           result.moves.back().rested;
  });
  section.claims.push_back({fmt::format("the report's sequence, {}, is played to its end and the tower stands", setting),
                            fmt::format("all {}", seeds), fmt::format("{} of {}", finished, seeds),
                            finished == static_cast<std::ptrdiff_t>(seeds)});
  for (std::size_t step = 0; step < moves.size(); ++step) {
    const StepResult of = stepOf(played, step);
    std::string measured = fmt::format("{:.3f} mm at most, {} of {} seeds", 1e3 * of.worst_m, of.within, seeds);
    if (moves[step].kind == MoveKind::put) measured += fmt::format("; the block itself {:.2f} mm", 1e3 * of.slide_m);
    section.claims.push_back({fmt::format("step {}, {}, {}: other blocks move", step + 1, describe(moves[step]), setting),
                              fmt::format("{:g} mm beyond rigid settlement", 1e3 * moves[step].allowed_m.value_or(0.0)), measured,
                              of.within == seeds});
  }
}

// How far a sequence ends from where it does otherwise: the most over the seeds, and in how many it is within kSamePlace_m.
StepResult apartAtEnd(const PlayedSequence& one, const PlayedSequence& other) {
  StepResult apart;
  for (std::size_t seed = 0; seed < one.seeds.size(); ++seed) {
    double farthest_m = 0.0;
    for (std::size_t b = 0; b < one.seeds[seed].places.size(); ++b)
      farthest_m = std::max(farthest_m, (one.seeds[seed].places[b] - other.seeds[seed].places[b]).norm());
    apart.worst_m = std::max(apart.worst_m, farthest_m);
    apart.within += farthest_m <= kSamePlace_m ? 1 : 0;
  }
  return apart;
}

std::string describe(const StepResult& apart, std::size_t seeds) {
  return fmt::format("{:.3f} mm apart at most, {} of {} within {:g} mm", 1e3 * apart.worst_m, apart.within, seeds,
                     1e3 * kSamePlace_m);
}

// The steps that are not within their bounds.
void addReported(const PlayedSequence& played, std::string_view setting, ValidationSection& section) {
  std::string measured;
  for (std::size_t step = 0; step < played.moves.size(); ++step) {
    const StepResult of = stepOf(played, step);
    if (of.within == played.seeds.size()) continue;
    measured += fmt::format("{}step {}: {:.3f} mm at most, {} of {} seeds within {:g} mm", measured.empty() ? "" : "; ", step + 1,
                            1e3 * of.worst_m, of.within, played.seeds.size(), 1e3 * played.moves[step].allowed_m.value_or(0.0));
  }
  section.claims.push_back(
      {fmt::format("{}: steps beyond their bounds", setting), "reported", measured.empty() ? "none" : measured});
}

// One sequence of removals by pulling: middle blocks along their length, outer ones sideways, the shorter way, as along their
// length they drag round what lies on their end. Slowly, or with a jerk.
struct RemovalSequence {
  std::string id;
  Scene scene;
  std::vector<bool> standsAfter;  // the first of them before any removal
  std::size_t statesRight = 0;    // of those after a removal
  std::string note;
};

// Whether friction holds a block too hard for its being drawn slowly.
bool holdsTooHard(const Scene& scene, BlockId block, const Vec3& towards) {
  const StaticScene statics = staticScene(scene);
  double normal_n = 0.0;
  for (const ContactLoad& load : contactLoads(statics).contacts) {
    if (load.upper == block || load.lower == block) normal_n += load.normal_n;
  }
  const std::optional<double> limit_n = pullLimit(statics, block, towards);
  return limit_n && kSlowShare * *limit_n < scene.staticFriction * normal_n;
}

std::vector<RemovalSequence> removalSequences(const ValidationPlan& plan) {
  std::vector<RemovalSequence> sequences;
  for (const Removals& removals : readRemovals(plan.oracle, plan.longForm ? kAllRemovals : 1)) {
    RemovalSequence sequence{removals.id, removals.scene, removals.standsAfter, 0, {}};
    Scene left = sequence.scene;
    for (const Removals::Place& place : removals.removed) {
      if (!plan.longForm && sequence.scene.moves.size() >= 2 * kShortRemovals) break;
      Move take;
      take.row = place.row;
      take.position = place.position;
      const bool alongX = take.row % 2 == 0;
      const Vec3 length = alongX ? Vec3::UnitX() : Vec3::UnitY();
      const Vec3 outwards = (take.position - 2) * (alongX ? Vec3::UnitY() : Vec3::UnitX());
      take.towards = take.position == 2 ? length : outwards;
      const auto block = std::find_if(left.blocks.begin(), left.blocks.end(), [&](const BlockSpec& spec) {
        return spec.row == take.row && spec.position == take.position;
      });
      const auto id = blockId(static_cast<std::size_t>(block - left.blocks.begin()));
      if (holdsTooHard(left, id, take.towards)) take.speed_m_s = kJerk_m_s;
      left.blocks.erase(block);
      Move away;
      away.kind = MoveKind::putAside;
      take.limit_n = away.limit_n = kStrongHand_n;
      sequence.scene.moves.insert(sequence.scene.moves.end(), {take, away});
    }
    sequences.push_back(sequence);
  }
  return sequences;
}

// After each removal the tower stands or not as statics says, the product's and the reference's.
void pullAll(RemovalSequence& sequence) {
  const RunResult result = play(sequence.scene).result;
  const std::size_t removals = sequence.scene.moves.size() / 2;
  for (std::size_t i = 0; i < removals; ++i) {
    const bool expected = sequence.standsAfter[i + 1];
    const bool played = 2 * i + 1 < result.moves.size() && result.moves[2 * i + 1].done;
    const bool right = expected ? played && result.moves[2 * i].statics != Rest::falls
                                : !result.standing.stands && (result.moves.size() == 2 * i || result.moves.size() == 2 * i + 1);
    if (!right) {
      const Move& move = sequence.scene.moves[2 * i];
      sequence.note = fmt::format("{}: removal {} ({}): statics says it {}; {}", sequence.id, i + 1, describe(move),
                                  expected ? "stands" : "falls", describe(result.standing));
      return;
    }
    ++sequence.statesRight;
  }
}

void addRemovalsByPulling(std::vector<RemovalSequence> sequences, Sleep sleep, ValidationSection& section) {
  for (RemovalSequence& sequence : sequences) sequence.scene.settings.sleep = sleep;
  tbb::parallel_for(std::size_t{0}, sequences.size(),
                    [&](std::size_t i) { tbb::this_task_arena::isolate([&] { pullAll(sequences[i]); }); });
  std::size_t right = 0;
  std::size_t all = 0;
  for (const RemovalSequence& sequence : sequences) {
    right += sequence.statesRight;
    all += sequence.scene.moves.size() / 2;
    if (!sequence.note.empty()) section.notes.push_back(sequence.note);
  }
  section.claims.push_back(
      {fmt::format("blocks pulled out of 18 rows one by one, sleep {}: simulation and statics agree after each",
                   sleep == Sleep::off ? "off" : "on"),
       "all", fmt::format("{} of {}", right, all), right == all});
}

}  // namespace

ValidationSection validateMoves(const ValidationPlan& plan) {
  ValidationSection section{
      "Moves",
      "The report's sequence of moves (its section 6.1.2, scenes/moves.toml) by a hand of at most 5 N, slow at "
      "4 cm/s and quick at 40 cm/s; allowed is what the real tower did. Blocks that are not loose have heights within 0.006 mm "
      "of "
      "one another. Then with heights that differ by all of the 0.02 mm within which they count as equal: in some seeds 3-1, "
      "which step 3 draws, then carries so large a load that its friction force is nearly the force at which the tower tips "
      "about its edge (0.80 N, with 1-1 loose), and the tower rocks: that is reported. "
      "How much the places in the end depend on heights is reported beside how much they depend on sleep. "
      "Then blocks are pulled out of a full tower of 18 rows one by one and put aside, middle blocks along their length and "
      "outer ones sideways, at 4 cm/s, or at 1.5 m/s where the friction force is above two thirds of the tipping force "
      "by statics; both ways again. "
      "After a state that differs a sequence is not counted further."};
  const PlayedSequence asleep = playSequence(plan, {});
  const PlayedSequence awake = playSequence(plan, {.sleep = Sleep::off});
  addSequence(asleep, "sleep on", section);
  addSequence(awake, "sleep off", section);
  const std::size_t seeds = awake.seeds.size();
  const StepResult apart = apartAtEnd(asleep, awake);
  section.claims.push_back({"the report's sequence: places in the end with sleep and without", "within 0.1 mm",
                            describe(apart, seeds), apart.within == seeds});
  StepResult scattered;
  for (std::size_t draw = 0; draw < kScatterDraws; ++draw) {
    const StepResult of = apartAtEnd(playSequence(plan, {.sleep = Sleep::off, .scatterDraw = draw}), awake);
    scattered.within += of.within;
    scattered.worst_m = std::max(scattered.worst_m, of.worst_m);
  }
  section.claims.push_back(
      {"the report's sequence, sleep off: places in the end where each block is up to 0.1 um higher or lower", "reported",
       describe(scattered, kScatterDraws * seeds)});
  const PlayedSequence unequalAsleep = playSequence(plan, {.heightsSigma_m = kUnequalHeightsSigma_m});
  const PlayedSequence unequalAwake = playSequence(plan, {.sleep = Sleep::off, .heightsSigma_m = kUnequalHeightsSigma_m});
  addReported(unequalAsleep, "heights that differ by 0.02 mm, sleep on", section);
  addReported(unequalAwake, "heights that differ by 0.02 mm, sleep off", section);
  section.claims.push_back({"heights that differ by 0.02 mm: places in the end with sleep and without", "reported",
                            describe(apartAtEnd(unequalAsleep, unequalAwake), seeds)});
  const std::vector<RemovalSequence> sequences = removalSequences(plan);
  addRemovalsByPulling(sequences, Sleep::on, section);
  addRemovalsByPulling(sequences, Sleep::off, section);
  return section;
}

}  // namespace springtower
