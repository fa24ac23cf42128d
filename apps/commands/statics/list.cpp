#include "apps/commands/statics/list.h"

#include "apps/commands/statics/report.h"
#include "apps/commands/verdict/json.h"
#include "apps/commands/verdict/verdict.h"
#include "apps/common/interruption.h"
#include "apps/common/json_values.h"
#include "apps/common/line_jobs.h"
#include "apps/common/line_reader.h"
#include "core/error.h"
#include "core/limits.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <oneapi/tbb/global_control.h>
#include <optional>
#include <set>

namespace springtower {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kTiltTolerance_deg = 0.1;

// What a line says beside what `verdict` reads.
struct Sequence {
  std::vector<std::size_t> remove;  // blocks of the whole tower
  std::vector<bool> expected;       // empty when nothing is expected
};

struct Answer {
  Rest rest = Rest::falls;
  std::optional<StabilityMargin> margin;
  std::vector<bool> standsAfter;  // of a sequence: at the start and after each removal
};

// A line, and its answer once that is known.
struct StaticsLine {
  std::size_t number = 0;
  std::string id;
  Json expect;
  std::optional<bool> clear;     // what is expected where that is clear
  std::vector<bool> sequence;    // what is expected of its states
  std::optional<Answer> answer;  // empty until then
};

[[noreturn]] void fail(const std::string& where, const Json& found, std::string_view allowed) {
  throw InputError(fmt::format("{}: expected {}, got {}", where, allowed,
                               inQuotes(found.dump(-1, ' ', true, Json::error_handler_t::replace))));
}

Sequence readSequence(const Json& remove, const Json& expected, const Scene& scene, const std::string& where) {
  Sequence sequence;
  if (!remove.is_array()) fail(where + ": remove", remove, "a list of {row, position}");
  for (const Json& place : remove) {
    const bool complete = place.is_object() && place.size() == 2 && place.contains("row") && place.contains("position") &&
                          place.at("row").is_number_integer() && place.at("position").is_number_integer();
    const auto block = std::find_if(scene.blocks.begin(), scene.blocks.end(), [&](const BlockSpec& candidate) {
      return complete && place.at("row") == candidate.row && place.at("position") == candidate.position;
    });
    const auto number = static_cast<std::size_t>(block - scene.blocks.begin());
    const bool again = std::find(sequence.remove.begin(), sequence.remove.end(), number) != sequence.remove.end();
    if (block == scene.blocks.end() || again) fail(where + ": remove", place, "the row and position of a block still there");
    sequence.remove.push_back(number);
  }
  if (expected.is_null()) return sequence;
  const bool fits = expected.is_array() && expected.size() == remove.size() + 1 &&
                    std::all_of(expected.begin(), expected.end(), [](const Json& value) { return value.is_boolean(); });
  if (!fits) fail(where + ": stands_after", expected, "a list of true and false, one more than there are removals");
  for (const Json& value : expected) sequence.expected.push_back(value.get<bool>());
  return sequence;
}

// Takes the keys of a sequence out of a line and has `verdict` read the rest.
std::pair<VerdictLine, std::optional<Sequence>> readLine(std::string text, std::size_t number, const std::string& where,
                                                         std::set<std::string>& ids) {
  Json json = parseVerdictLine(text, where);
  if (!json.is_object() || (!json.contains("remove") && !json.contains("stands_after"))) {
    return {readVerdictLine(text, number, where, ids), std::nullopt};
  }
  if (!json.contains("remove"))
    throw InputError(where + ": expected both remove and stands_after, got stands_after without remove");
  const Json remove = json.at("remove");
  const Json after = json.contains("stands_after") ? json.at("stands_after") : Json(nullptr);
  json.erase("remove");
  json.erase("stands_after");
  text = jsonText(json);
  VerdictLine line = readVerdictLine(text, number, where, ids);
  try {
    Sequence sequence = readSequence(remove, after, line.scene, where);
    return {std::move(line), std::move(sequence)};
  } catch (const InputError&) {
    ids.erase(line.id);  // a bad line is left out with its id
    throw;
  }
}

Answer solve(const VerdictLine& line, const std::optional<Sequence>& sequence) {
  endIfInterrupted();
  const StaticScene statics = staticScene(line.scene);
  Answer answer{statics.rest, tiltMargin(statics), {}};
  if (!sequence) return answer;
  answer.standsAfter.push_back(statics.rest != Rest::falls);
  std::vector<char> gone(line.scene.blocks.size(), 0);
  for (const std::size_t block : sequence->remove) {
    endIfInterrupted();
    gone[block] = 1;
    Scene rest = line.scene;
    rest.blocks.clear();
    for (std::size_t b = 0; b < gone.size(); ++b) {
      if (gone[b] == 0) rest.blocks.push_back(line.scene.blocks[b]);
    }
    answer.standsAfter.push_back(rest.blocks.empty() || staticScene(rest).rest != Rest::falls);
  }
  return answer;
}

std::optional<double> expectedTilt(const StaticsLine& line) {
  if (!line.clear || !line.expect.contains("tilt_deg") || !line.expect.at("tilt_deg").is_number()) return {};
  return line.expect.at("tilt_deg").get<double>();
}

// How many agree, and by how much the worst differs.
struct Count {
  std::size_t all = 0;
  std::size_t agree = 0;
  double worst = 0.0;
  void add(bool agrees, double difference = 0.0) {
    ++all;
    agree += agrees ? 1 : 0;
    worst = std::max(worst, difference);
  }
};

bool printAgreement(const std::deque<StaticsLine>& lines) {
  Count stands;
  Count falls;
  Count states;
  Count tilts;
  Count fallenTilts;
  std::string differing;
  for (const StaticsLine& line : lines) {
    if (!line.answer) continue;
    const Answer& answer = *line.answer;
    const std::string where = fmt::format("  line {}: {}", line.number, onOneLine(line.id));
    const bool standing = answer.rest != Rest::falls;
    if (line.clear) {
      (*line.clear ? stands : falls).add(standing == *line.clear);
      if (standing != *line.clear) differing += fmt::format("{} {}\n", where, standing ? "stands" : "falls");
    }
    if (const std::optional<double> expected = expectedTilt(line)) {
      const double difference = answer.margin ? std::abs(answer.margin->tilt_deg - *expected) : 180.0;
      const bool agrees = difference <= kTiltTolerance_deg;
      (*expected >= 0.0 ? tilts : fallenTilts).add(agrees, difference);
      if (*expected >= 0.0 && !agrees) differing += fmt::format("{} differs by {:.3f} deg of tilt\n", where, difference);
    }
    for (std::size_t state = 0; state < line.sequence.size(); ++state) {
      const bool agrees = line.sequence[state] == answer.standsAfter[state];
      states.add(agrees);
      if (!agrees) differing += fmt::format("{} differs after {} removals\n", where, state);
    }
  }
  fmt::print(stderr, "  {:<24}{:>9}{:>9}{:>9}{:>12}\n", "expected", "clear", "agree", "differ", "worst deg");
  const auto row = [](std::string_view name, const Count& count, bool tilt) {
    if (count.all == 0) return;
    fmt::print(stderr, "  {:<24}{:>9}{:>9}{:>9}{:>12}\n", name, count.all, count.agree, count.all - count.agree,
               tilt ? fmt::format("{:.4f}", count.worst) : "");
  };
  row("stands", stands, false);
  row("falls", falls, false);
  row("states of sequences", states, false);
  row("tilt where it stands", tilts, true);
  row("tilt where it falls (*)", fallenTilts, true);
  if (fallenTilts.all > 0) fmt::print(stderr, "  (*) how far it is from standing; not judged\n");
  fmt::print(stderr, "{}", differing);
  return differing.empty();
}

std::string answerLine(const StaticsLine& line) {
  Json json = {{"id", line.id}};
  json.update(restJson(line.answer->rest, line.answer->margin));
  if (!line.answer->standsAfter.empty()) json["stands_after"] = line.answer->standsAfter;
  if (!line.expect.is_null()) json["expect"] = line.expect;
  return json.dump() + '\n';
}

}  // namespace

int executeStaticsList(const std::string& file, bool check, bool keepGoing, int threads) {
  LineReader input(file);
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(threads));
  std::set<std::string> ids;
  std::deque<StaticsLine> lines;  // places in it stay
  const LineCounts counts =
      workOffLines(input, threads, keepGoing, [&](const std::string& text, std::size_t number, const std::string& where) {
        if (isBlankLine(text)) return LineJob{};
        auto [line, sequence] = readLine(text, number, where, ids);
        StaticsLine& known = lines.emplace_back();
        known.number = number;
        known.id = line.id;
        known.expect = line.expect;
        if (isClear(line)) known.clear = line.expect.at("stands").get<bool>();
        if (sequence) known.sequence = sequence->expected;
        return LineJob([line = std::move(line), sequence = std::move(sequence), &known] {
          known.answer = solve(line, sequence);
          return answerLine(known);
        });
      });
  const bool judged = std::any_of(lines.begin(), lines.end(),
                                  [](const StaticsLine& line) { return line.clear.has_value() || !line.sequence.empty(); });
  if (check && !judged && !counts.interrupted) {
    throw InputError("--check: expected at least one line with a clear expectation or stands_after, got none");
  }
  return exitCodeOf(counts, check && !printAgreement(lines) ? 1 : 0);
}

}  // namespace springtower
