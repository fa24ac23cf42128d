#include "apps/commands/validate/frames.h"
#include "apps/commands/validate/removals.h"
#include "apps/commands/validate/validate.h"
#include "apps/commands/verdict/verdict.h"
#include "core/error.h"
#include "solver/runner/run.h"
#include "solver/statics/statics.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <fstream>
#include <nlohmann/json.hpp>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>

namespace springtower {
namespace {

constexpr double kSeconds = 10.0;
constexpr double kWatch_s = 0.5;
constexpr double kSameEnd_m = 1e-4;
constexpr double kSameTime = 0.05;
constexpr std::size_t kMaxNotes = 12;

struct OracleSet {
  std::string_view name;
  std::size_t every;  // in the quick form only each so-manieth line
};
constexpr std::array<OracleSet, 4> kSets = {{{"small", 8}, {"shift", 4}, {"loose", 4}, {"r18", 7}}};

// What became of one tower, once with sleep and once without.
struct Fate {
  std::string divergence;
  Standing standing;
  double fall_s = 0.0;
  ParticleArray end;
};

Fate fateOf(Scene scene, Sleep sleep) {
  scene.settings.sleep = sleep;
  RunOptions options;
  options.seconds = kSeconds;
  options.stopWhenFallen = true;
  options.stopWhenAtRest = true;
  options.secondsAfterRest = kWatch_s;
  options.measureEveryFrame = false;
  Fate fate;
  try {
    Simulation simulation(scene);
    const RunResult result = runSceneOrEnd(simulation, options);
    fate.standing = result.standing;
    fate.fall_s = result.fallTime_s.value_or(0.0);
    fate.end = simulation.state.position;
  } catch (const DivergenceError& error) {
    fate.divergence = error.what();
  }
  return fate;
}

std::string wordsFor(const Fate& fate) {
  if (!fate.divergence.empty()) return "diverges";
  return fate.standing.stands ? "stands" : "falls";
}

bool sameVerdict(const Fate& a, const Fate& b) {
  return a.divergence.empty() && b.divergence.empty() && a.standing.stands == b.standing.stands;
}

std::optional<bool> clearVerdict(const VerdictLine& line) {
  if (!isClear(line)) return {};
  return line.expect.at("stands").get<bool>();
}

// How many of a set agree.
struct Counts {
  std::size_t clear = 0;
  std::array<std::size_t, 2> agree{};  // with sleep, without
  std::size_t all = 0;
  std::size_t same = 0;
  std::size_t standing = 0;
  std::size_t sameEnd = 0;
  double worstEnd_m = 0.0;
  std::size_t fallen = 0;
  std::size_t sameFall = 0;
  double worstTime = 0.0;
};

void count(const std::string& id, const std::optional<bool>& expected, const std::array<Fate, 2>& fates, Counts& counts,
           std::vector<std::string>& notes) {
  ++counts.all;
  if (expected) {
    ++counts.clear;
    for (std::size_t s = 0; s < 2; ++s) {
      const bool agrees = fates[s].divergence.empty() && fates[s].standing.stands == *expected;
      counts.agree[s] += agrees ? 1 : 0;
      if (!agrees) {
        notes.push_back(fmt::format("{}: {} with sleep {}, statics: {}", id, wordsFor(fates[s]), s == 0 ? "on" : "off",
                                    *expected ? "stands" : "falls"));
      }
    }
  }
  if (!sameVerdict(fates[0], fates[1])) {
    notes.push_back(fmt::format("{}: {} with sleep on, {} with sleep off", id, wordsFor(fates[0]), wordsFor(fates[1])));
    return;
  }
  ++counts.same;
  if (fates[0].standing.stands) {
    ++counts.standing;
    const double apart = largestCornerMove(fates[0].end, fates[1].end);
    counts.worstEnd_m = std::max(counts.worstEnd_m, apart);
    counts.sameEnd += apart <= kSameEnd_m ? 1 : 0;
    if (apart > kSameEnd_m) notes.push_back(fmt::format("{}: ends {:.3f} mm apart with sleep on and off", id, 1e3 * apart));
    return;
  }
  ++counts.fallen;
  const double late = std::abs(fates[0].fall_s - fates[1].fall_s) / fates[1].fall_s;
  const bool sameBlock = fates[0].standing.block == fates[1].standing.block;
  counts.worstTime = std::max(counts.worstTime, late);
  counts.sameFall += sameBlock && late <= kSameTime ? 1 : 0;
  if (!sameBlock || late > kSameTime) {
    notes.push_back(fmt::format("{}: falls at {:.3f} s (block {}) with sleep on, {:.3f} s (block {}) with sleep off", id,
                                fates[0].fall_s, index(fates[0].standing.block), fates[1].fall_s,
                                index(fates[1].standing.block)));
  }
}

std::vector<VerdictLine> linesOf(const ValidationPlan& plan, const OracleSet& set) {
  const std::string path = fmt::format("{}/{}.jsonl", plan.oracle, set.name);
  std::ifstream file(path);
  if (!file) throw InputError(fmt::format("--oracle: expected the folder of the reference sets, got no file {}", path));
  std::vector<VerdictLine> all = readVerdictLines(file, path);
  if (plan.longForm) return all;
  std::vector<VerdictLine> part;
  for (std::size_t i = 0; i < all.size(); i += set.every) part.push_back(all[i]);
  return part;
}

void addClaims(const OracleSet& set, const Counts& counts, ValidationSection& section) {
  const std::string name(set.name);
  for (std::size_t s = 0; s < 2; ++s) {
    section.claims.push_back({fmt::format("{}: clear verdicts right, sleep {}", name, s == 0 ? "on" : "off"), "all",
                              fmt::format("{} of {}", counts.agree[s], counts.clear), counts.agree[s] == counts.clear});
  }
  section.claims.push_back({name + ": same verdict with sleep on and off, marginal ones too", "all",
                            fmt::format("{} of {}", counts.same, counts.all), counts.same == counts.all});
  section.claims.push_back({name + ": towers that stand end in the same place", "all within 0.1 mm",
                            fmt::format("{} of {}, worst {:.4f} mm", counts.sameEnd, counts.standing, 1e3 * counts.worstEnd_m),
                            counts.sameEnd == counts.standing});
  section.claims.push_back({name + ": towers that fall, same first block and time", "all within 5 %",
                            fmt::format("{} of {}, worst {:.2f} %", counts.sameFall, counts.fallen, 100.0 * counts.worstTime),
                            counts.sameFall == counts.fallen});
}

// Every state of the sequences of removals, each as a tower of its own.
void addRemovalStatics(const ValidationPlan& plan, ValidationSection& section) {
  struct State {
    std::string id;
    Scene scene;
    bool expected;
  };
  std::vector<State> states;
  for (const Removals& removals : readRemovals(plan.oracle, plan.longForm ? kAllRemovals : 1)) {
    Scene scene = removals.scene;
    const std::size_t last = removals.removed.size();
    for (std::size_t step = 0; step <= last; ++step) {
      if (step > 0) {
        const Removals::Place& place = removals.removed[step - 1];
        std::erase_if(scene.blocks,
                      [&](const BlockSpec& block) { return place.row == block.row && place.position == block.position; });
      }
      if (!plan.longForm && step % 4 != 0 && step != last) continue;
      states.push_back({fmt::format("{} after {}", removals.id, step), scene, removals.standsAfter[step]});
    }
  }
  std::vector<char> agrees(states.size());
  tbb::parallel_for(std::size_t{0}, states.size(), [&](std::size_t i) {
    tbb::this_task_arena::isolate([&] {
      const Fate fate = fateOf(states[i].scene, Sleep::on);
      agrees[i] = fate.divergence.empty() && fate.standing.stands == states[i].expected ? 1 : 0;
    });
  });
  const auto right = static_cast<std::size_t>(std::count(agrees.begin(), agrees.end(), 1));
  for (std::size_t i = 0; i < states.size(); ++i) {
    if (agrees[i] == 0) section.notes.push_back(states[i].id + ": differs from statics");
  }
  section.claims.push_back({"removal: states of 18 rows with blocks left out", "all",
                            fmt::format("{} of {}", right, states.size()), right == states.size()});
}

}  // namespace

ValidationSection validateVerdicts(const ValidationPlan& plan) {
  ValidationSection section{"Verdicts",
                            "Towers of the reference sets, whose verdicts are those of rigid statics, simulated until they have "
                            "fallen or are at rest (10 s at most), once with sleep and once without."};
  if (!plan.longForm) section.text += " The short form takes a part of each set.";
  for (const OracleSet& set : kSets) {
    const std::vector<VerdictLine> lines = linesOf(plan, set);
    std::vector<std::array<Fate, 2>> fates(lines.size());
    tbb::parallel_for(std::size_t{0}, 2 * lines.size(), [&](std::size_t i) {
      tbb::this_task_arena::isolate(
          [&] { fates[i / 2][i % 2] = fateOf(lines[i / 2].scene, i % 2 == 0 ? Sleep::on : Sleep::off); });
    });
    Counts counts;
    for (std::size_t i = 0; i < lines.size(); ++i) {
      count(lines[i].id, clearVerdict(lines[i]), fates[i], counts, section.notes);
    }
    addClaims(set, counts, section);
  }
  addRemovalStatics(plan, section);
  if (section.notes.size() > kMaxNotes) {
    const std::size_t more = section.notes.size() - kMaxNotes;
    section.notes.resize(kMaxNotes);
    section.notes.push_back(fmt::format("and {} more", more));
  }
  return section;
}

}  // namespace springtower
