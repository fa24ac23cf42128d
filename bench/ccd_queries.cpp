// Runs a set of continuous collision queries with known answers: judges every answer and times every query.
#include "core/error.h"
#include "core/limits.h"
#include "core/output_file.h"
#include "narrowphase/exact/query_set.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <exception>
#include <fmt/format.h>
#include <memory>
#include <numeric>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace springtower {
namespace {

constexpr int kBadInput = 2;
constexpr int kProgramError = 70;

constexpr const char* kFooter =
    "A set is a comma-separated file with the columns id, set, src, family, gt (1: the features meet), toi (when first),\n"
    "min_dist, gt_f32, a0x a0y a0z b0x .. d0z at t = 0 and a1x .. d1z at t = 1. Columns of the table:\n"
    "  missed    the features meet, no hit is reported (must be 0)\n"
    "  late      the reported time is after the exact one (must be 0)\n"
    "  false     the features never meet, a hit is reported\n"
    "  far       false hits farther apart than the stated error (must be 0)\n"
    "  ns        time of one query: the median of 15 runs through the set, less the time of reading the clock\n"
    "Each query is decided by swept boxes, by the sign of the coplanarity cubic, by refinement of its roots in floating\n"
    "point, or by exact arithmetic, in this order; the second table counts that.\n"
    "examples:\n"
    "  ccd_queries vf.csv --kind vf\n"
    "  ccd_queries ee.csv --kind ee --out answers.csv\n"
    "exit codes: 0 done, 2 bad input or arguments";

struct Options {
  std::string path;
  QueryKind kind = QueryKind::pointTriangle;
  std::optional<std::string> out;
};

struct Answer {
  TimeOfImpact impact;
  DecidedBy decidedBy;
  double time_ns;
};

using Clock = std::chrono::steady_clock;

double nanosecondsSince(Clock::time_point start) {
  return std::chrono::duration<double, std::nano>(Clock::now() - start).count();
}

double quantile(std::span<double> values, double fraction) {
  const auto rank = std::min(static_cast<std::size_t>(fraction * static_cast<double>(values.size())), values.size() - 1);
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(rank), values.end());
  return values[rank];
}

/// Answers all queries several times in their order, so that neighbouring runs of one query lie a whole set apart.
std::vector<Answer> run(const std::vector<CollisionQuery>& queries, QueryKind kind) {
  constexpr std::size_t kRuns = 15;
  std::vector<double> clock(1001);
  for (double& time_ns : clock) time_ns = nanosecondsSince(Clock::now());
  const double clock_ns = quantile(clock, 0.5);

  std::vector<Answer> answers(queries.size());
  std::vector<double> times_ns(queries.size() * kRuns);
  for (std::size_t r = 0; r < kRuns; ++r)
    for (std::size_t i = 0; i < queries.size(); ++i) {
      const Clock::time_point start = Clock::now();
      answers[i].impact = answer(queries[i], kind, &answers[i].decidedBy);
      times_ns[i * kRuns + r] = nanosecondsSince(start);
    }
  for (std::size_t i = 0; i < queries.size(); ++i)
    answers[i].time_ns = std::max(quantile(std::span(times_ns).subspan(i * kRuns, kRuns), 0.5) - clock_ns, 0.0);
  return answers;
}

void writeAnswers(OutputFile& file, const std::vector<CollisionQuery>& queries, const std::vector<Answer>& answers) {
  file.stream() << "id,hit,toi\n";
  for (std::size_t i = 0; i < queries.size(); ++i) {
    const TimeOfImpact& impact = answers[i].impact;
    file.stream() << (impact.hit ? fmt::format("{},1,{}\n", queries[i].id, impact.time) : fmt::format("{},0,\n", queries[i].id));
  }
  file.commit();
}

void printTables(const std::vector<CollisionQuery>& queries, const std::vector<Answer>& answers) {
  std::size_t meeting = 0, missed = 0, late = 0, falseHits = 0, far = 0;
  std::array<std::size_t, 4> decided{};
  std::vector<double> times_ns;
  for (std::size_t i = 0; i < queries.size(); ++i) {
    const QueryMistakes mistakes = judge(queries[i], answers[i].impact);
    meeting += queries[i].exact.hit;
    missed += mistakes.missed;
    late += mistakes.late;
    falseHits += mistakes.falseHit;
    far += mistakes.falseBeyondError;
    ++decided[static_cast<std::size_t>(answers[i].decidedBy)];
    times_ns.push_back(answers[i].time_ns);
  }
  const double mean_ns = std::accumulate(times_ns.begin(), times_ns.end(), 0.0) / static_cast<double>(times_ns.size());
  fmt::print("{:>8} {:>8} {:>8} {:>8} {:>8} {:>8} {:>10} {:>10} {:>10}\n", "queries", "meeting", "missed", "late", "false", "far",
             "mean ns", "median ns", "p99 ns");
  fmt::print("{:>8} {:>8} {:>8} {:>8} {:>8} {:>8} {:>10.1f} {:>10.1f} {:>10.1f}\n", queries.size(), meeting, missed, late,
             falseHits, far, mean_ns, quantile(times_ns, 0.5), quantile(times_ns, 0.99));
  fmt::print("\n{:>10} {:>8} {:>8} {:>8} {:>8}\n", "decided by", "boxes", "cubic", "refined", "exact");
  fmt::print("{:>10} {:>8} {:>8} {:>8} {:>8}\n", "queries", decided[0], decided[1], decided[2], decided[3]);
  fmt::print("stated error: {:.0e} of the largest coordinate difference of a query\n", kContactError);
}

int complain(const std::string& message, int code) {
  std::fputs(fmt::format("ccd_queries: {}\n", onOneLine(message)).c_str(), stderr);  // throws nothing where it takes nothing
  return code;
}

int runProgram(int argc, char** argv) {
  CLI::App program("Runs continuous collision queries with known answers, judges and times them.", "ccd_queries");
  Options options;
  program.set_help_flag("-h,--help", "prints this help");
  program.add_option("FILE", options.path, "the set of queries")->required()->type_name("FILE.csv");
  std::string kind;
  program.add_option("--kind", kind, "vf: point (a) and triangle (b c d); ee: edges (a-b and c-d)")
      ->required()
      ->type_name("vf|ee")
      ->check(CLI::IsMember({"vf", "ee"}).description(""));
  program.add_option("--out", options.out, "writes the answers: id,hit,toi, one query a line")->type_name("FILE.csv");
  program.footer(kFooter);
  try {
    program.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return program.exit(error);
    // CLI11 names unknown arguments from the last to the first.
    const std::vector<std::string> unknown = program.remaining();
    const std::string what = unknown.empty() ? error.what()
                                             : fmt::format("expected arguments that --help lists, got the unknown arguments {}",
                                                           fmt::join(unknown, ", "));
    return complain(what + " (try 'ccd_queries --help')", kBadInput);
  }
  options.kind = kind == "vf" ? QueryKind::pointTriangle : QueryKind::edgeEdge;
  const std::vector<CollisionQuery> queries = readCollisionQueries(options.path);
  const auto file = options.out ? std::make_unique<OutputFile>(*options.out, "--out") : nullptr;
  const std::vector<Answer> answers = run(queries, options.kind);
  if (file) writeAnswers(*file, queries, answers);
  printTables(queries, answers);
  return 0;
}

}  // namespace
}  // namespace springtower

int main(int argc, char** argv) {
  try {
    const int code = springtower::runProgram(argc, argv);
    // A full disk or a closed pipe behind standard output must not pass unseen.
    if (std::fflush(stdout) != 0) return springtower::complain("standard output: writing failed", springtower::kBadInput);
    return code;
  } catch (const springtower::InputError& error) {
    return springtower::complain(error.what(), springtower::kBadInput);
  } catch (const std::exception& error) {
    return springtower::complain(error.what(), springtower::kProgramError);
  }
}
