#include "apps/commands/statics/list.h"

#include "apps/commands/statics/report.h"
#include "apps/commands/verdict/json.h"
#include "apps/commands/verdict/verdict.h"
#include "core/error.h"
#include "core/limits.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <fstream>
#include <iostream>
#include <map>
#include <nlohmann/json.hpp>
#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/parallel_for.h>
#include <sstream>

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

struct Lines {
  std::vector<VerdictLine> lines;
  std::map<std::size_t, Sequence> sequences;  // by the number of the line
};

[[noreturn]] void fail(const std::string& where, const Json& found, std::string_view allowed) {
  throw InputError(fmt::format("{}: found {}, allowed is {}", where,
                               inQuotes(found.dump(-1, ' ', true, Json::error_handler_t::replace)), allowed));
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

// Takes the keys of sequences out of the lines and has `verdict` read the rest, whose complaints keep the numbers of the lines.
Lines readLines(std::istream& input, const std::string& source) {
  std::map<std::size_t, std::pair<Json, Json>> found;
  std::string rest;
  std::string text;
  for (std::size_t number = 1; std::getline(input, text); ++number) {
    const std::string where = fmt::format("{}: line {}", source, number);
    Json json = isBlankLine(text) ? Json(nullptr) : parseVerdictLine(text, where);
    if (json.is_object() && (json.contains("remove") || json.contains("stands_after"))) {
      if (!json.contains("remove")) throw InputError(where + ": found stands_after without remove, allowed is both");
      found[number] = {json.at("remove"), json.contains("stands_after") ? json.at("stands_after") : Json(nullptr)};
      json.erase("remove");
      json.erase("stands_after");
      text = json.dump(-1, ' ', true, Json::error_handler_t::replace);
    }
    rest += text + '\n';
  }
  if (input.bad()) throw InputError(fmt::format("{}: reading failed", source));
  std::istringstream stream(rest);
  Lines lines;
  lines.lines = readVerdictLines(stream, source);
  for (const VerdictLine& line : lines.lines) {
    const auto sequence = found.find(line.number);
    if (sequence == found.end()) continue;
    lines.sequences[line.number] = readSequence(sequence->second.first, sequence->second.second, line.scene,
                                                fmt::format("{}: line {}", source, line.number));
  }
  return lines;
}

Answer solve(const VerdictLine& line, const Sequence* sequence) {
  const StaticScene statics = staticScene(line.scene);
  Answer answer{statics.rest, tiltMargin(statics), {}};
  if (sequence == nullptr) return answer;
  answer.standsAfter.push_back(statics.rest != Rest::falls);
  std::vector<char> gone(line.scene.blocks.size(), 0);
  for (const std::size_t block : sequence->remove) {
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

std::optional<double> expectedTilt(const VerdictLine& line) {
  if (!isClear(line) || !line.expect.contains("tilt_deg") || !line.expect.at("tilt_deg").is_number()) return {};
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

bool printAgreement(const Lines& lines, const std::vector<Answer>& answers) {
  Count stands;
  Count falls;
  Count states;
  Count tilts;
  Count fallenTilts;
  std::string differing;
  for (std::size_t i = 0; i < answers.size(); ++i) {
    const VerdictLine& line = lines.lines[i];
    const std::string where = fmt::format("  line {}: {}", line.number, onOneLine(line.id));
    const bool standing = answers[i].rest != Rest::falls;
    if (isClear(line)) {
      const bool expected = line.expect.at("stands").get<bool>();
      (expected ? stands : falls).add(standing == expected);
      if (standing != expected) differing += fmt::format("{} {}\n", where, standing ? "stands" : "falls");
    }
    if (const std::optional<double> expected = expectedTilt(line)) {
      const double difference = answers[i].margin ? std::abs(answers[i].margin->tilt_deg - *expected) : 180.0;
      const bool agrees = difference <= kTiltTolerance_deg;
      (*expected >= 0.0 ? tilts : fallenTilts).add(agrees, difference);
      if (*expected >= 0.0 && !agrees) differing += fmt::format("{} differs by {:.3f} deg of tilt\n", where, difference);
    }
    const auto sequence = lines.sequences.find(line.number);
    if (sequence == lines.sequences.end()) continue;
    for (std::size_t state = 0; state < sequence->second.expected.size(); ++state) {
      const bool agrees = sequence->second.expected[state] == answers[i].standsAfter[state];
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

Lines readFile(const std::string& file) {
  if (file == "-") return readLines(std::cin, "standard input");
  std::ifstream stream(file);
  if (!stream) throw InputError(fmt::format("{}: cannot be read", onOneLine(file)));
  return readLines(stream, onOneLine(file));
}

}  // namespace

int executeStaticsList(const std::string& file, bool check, int threads) {
  const Lines lines = readFile(file);
  const bool judged = std::any_of(lines.lines.begin(), lines.lines.end(), isClear) ||
                      std::any_of(lines.sequences.begin(), lines.sequences.end(),
                                  [](const auto& sequence) { return !sequence.second.expected.empty(); });
  if (check && !judged) {
    throw InputError("--check: found no line with a clear expectation or stands_after, allowed is at least one");
  }
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(threads));
  std::vector<Answer> answers(lines.lines.size());
  tbb::parallel_for(std::size_t{0}, answers.size(), [&](std::size_t i) {
    const auto sequence = lines.sequences.find(lines.lines[i].number);
    answers[i] = solve(lines.lines[i], sequence == lines.sequences.end() ? nullptr : &sequence->second);
  });
  std::string output;
  for (std::size_t i = 0; i < answers.size(); ++i) {
    Json json = {{"id", lines.lines[i].id}};
    json.update(restJson(answers[i].rest, answers[i].margin));
    if (!answers[i].standsAfter.empty()) json["stands_after"] = answers[i].standsAfter;
    if (!lines.lines[i].expect.is_null()) json["expect"] = lines.lines[i].expect;
    output += json.dump() + '\n';
  }
  std::cout << output << std::flush;
  return check && !printAgreement(lines, answers) ? 1 : 0;
}

}  // namespace springtower
