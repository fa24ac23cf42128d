#include "apps/moves_report.h"
#include "apps/validate.h"
#include "core/error.h"
#include "solver/statics.h"

#include <algorithm>
#include <fmt/format.h>
#include <fstream>
#include <nlohmann/json.hpp>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>
#include <optional>

namespace springtower {
namespace {

constexpr double kLongest_s = 600.0;
constexpr double kStrongHand_n = 20.0;  // a block that bears the whole tower has to come as well
// A block is jerked out where friction holds it by more than this share of what the tower bears: a slow hand, or one at 0.4 m/s,
// draws such towers over, and statics alone does not see it.
constexpr double kSlowShare = 2.0 / 3.0;
constexpr double kJerk_m_s = 1.5;
constexpr std::size_t kShortRemovals = 3;  // of the first sequence

RunResult play(const Scene& scene) {
  RunOptions options;
  options.seconds = kLongest_s;
  options.measureEveryFrame = false;
  Simulation simulation(scene);
  return runScene(simulation, options);
}

// Heights that are more equal than the 0.02 mm within which those of the scene vary, m, standard deviation.
constexpr double kEqualHeightsSigma_m = 1e-6;

// The report's sequence, played once a seed.
struct PlayedSequence {
  std::vector<Move> moves;
  std::vector<RunResult> results;
};

PlayedSequence playSequence(const ValidationPlan& plan, Sleep sleep, std::optional<double> heightsSigma_m) {
  const std::size_t seeds = plan.longForm ? 10 : 1;
  std::vector<Scene> scenes;
  for (std::size_t seed = 1; seed <= seeds; ++seed) {
    TowerOptions options;
    options.seed = seed;
    options.heightsSigma_m = heightsSigma_m;
    scenes.push_back(sceneFromName(plan.scenes + "/moves.toml", options));
    scenes.back().settings.sleep = sleep;
  }
  PlayedSequence played{scenes.front().moves, std::vector<RunResult>(seeds)};
  tbb::parallel_for(std::size_t{0}, seeds,
                    [&](std::size_t i) { tbb::this_task_arena::isolate([&] { played.results[i] = play(scenes[i]); }); });
  return played;
}

// One claim that the sequence comes to its end, and one a step.
void addSequence(const PlayedSequence& played, std::string_view setting, ValidationSection& section) {
  const std::vector<Move>& moves = played.moves;
  const std::vector<RunResult>& results = played.results;
  const auto finished = std::count_if(results.begin(), results.end(), [&](const RunResult& result) {
    return result.standing.stands && result.moves.size() == moves.size() && result.moves.back().done &&
           result.moves.back().rested;
  });
  section.claims.push_back({fmt::format("the report's sequence, {}, is played to its end and the tower stands", setting),
                            fmt::format("all {}", results.size()), fmt::format("{} of {}", finished, results.size()),
                            finished == std::ssize(results)});
  for (std::size_t step = 0; step < moves.size(); ++step) {
    std::size_t within = 0;
    double worst_m = 0.0;
    double slide_m = 0.0;
    for (const RunResult& result : results) {
      if (step >= result.moves.size()) continue;
      within += isWithin(moves[step], result.moves[step]) ? 1 : 0;
      worst_m = std::max(worst_m, result.moves[step].moved_m - result.moves[step].settlement_m);
      slide_m = std::max(slide_m, result.moves[step].slide_m);
    }
    std::string measured = fmt::format("{:.3f} mm at most, {} of {} seeds", 1e3 * worst_m, within, results.size());
    if (moves[step].kind == MoveKind::put) measured += fmt::format("; the block itself {:.2f} mm", 1e3 * slide_m);
    section.claims.push_back({fmt::format("step {}, {}, {}: other blocks move", step + 1, describe(moves[step]), setting),
                              fmt::format("{:g} mm beyond rigid settlement", 1e3 * moves[step].allowed_m.value_or(0.0)), measured,
                              within == results.size()});
  }
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
  const std::string path = plan.oracle + "/removal.jsonl";
  std::ifstream file(path);
  if (!file) throw InputError(fmt::format("--oracle: found no file {}, allowed is the folder of the reference sets", path));
  std::vector<RemovalSequence> sequences;
  for (std::string text; std::getline(file, text);) {
    if (text.empty()) continue;
    const nlohmann::json line = nlohmann::json::parse(text);
    RemovalSequence sequence;
    sequence.id = line.at("id").get<std::string>();
    sequence.scene = bitCodeScene(line.at("config").get<std::string>());
    sequence.standsAfter = line.at("stands_after").get<std::vector<bool>>();
    Scene left = sequence.scene;
    for (const nlohmann::json& place : line.at("remove")) {
      if (!plan.longForm && sequence.scene.moves.size() >= 2 * kShortRemovals) break;
      Move take;
      take.row = place.at("row").get<int>();
      take.position = place.at("position").get<int>();
      const bool alongX = take.row % 2 == 0;
      const Vec3 length = alongX ? Vec3::UnitX() : Vec3::UnitY();
      const Vec3 outwards = (take.position - 2) * (alongX ? Vec3::UnitY() : Vec3::UnitX());
      take.towards = take.position == 2 ? length : outwards;
      const auto block = std::find_if(left.blocks.begin(), left.blocks.end(), [&](const BlockSpec& spec) {
        return spec.row == take.row && spec.position == take.position;
      });
      if (block == left.blocks.end())
        throw InputError(fmt::format("--oracle: {} takes a block from row {}, position {}, where none is left", sequence.id,
                                     take.row, take.position));
      const auto id = blockId(static_cast<std::size_t>(block - left.blocks.begin()));
      if (holdsTooHard(left, id, take.towards)) take.speed_m_s = kJerk_m_s;
      left.blocks.erase(block);
      Move away;
      away.kind = MoveKind::putAside;
      take.limit_n = away.limit_n = kStrongHand_n;
      sequence.scene.moves.insert(sequence.scene.moves.end(), {take, away});
    }
    sequences.push_back(sequence);
    if (!plan.longForm) break;
  }
  return sequences;
}

// After each removal the tower stands or not as statics says, the product's and the reference's.
void pullAll(RemovalSequence& sequence) {
  const RunResult result = play(sequence.scene);
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
      "4 cm/s and quick at 40 cm/s; allowed is what the real tower did. Blocks that are not loose have heights within 0.02 mm of "
      "one another; once more with nothing asleep, and with nothing asleep and heights within 0.006 mm: those within 0.02 mm may "
      "jam the block of step 3, and a hand that draws it slowly then rocks a tower that is awake. "
      "Then blocks are pulled out of a full tower of 18 rows one by one and put aside, middle blocks along their length and "
      "outer ones sideways, at 4 cm/s, or at 1.5 m/s where friction asks for more than two thirds of the pull that the tower "
      "bears by statics; both ways again. "
      "After a state that differs a sequence is not counted further."};
  addSequence(playSequence(plan, Sleep::on, std::nullopt), "sleep on", section);
  addSequence(playSequence(plan, Sleep::off, std::nullopt), "sleep off", section);
  addSequence(playSequence(plan, Sleep::off, kEqualHeightsSigma_m), "sleep off, heights within 0.006 mm", section);
  const std::vector<RemovalSequence> sequences = removalSequences(plan);
  addRemovalsByPulling(sequences, Sleep::on, section);
  addRemovalsByPulling(sequences, Sleep::off, section);
  return section;
}

}  // namespace springtower
