#include "apps/commands/validate/command.h"

#include "apps/commands/validate/kept.h"
#include "apps/commands/validate/page.h"
#include "apps/common/interruption.h"
#include "apps/common/options.h"
#include "apps/common/output_file.h"
#include "apps/common/program.h"
#include "core/error.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fmt/format.h>
#include <functional>
#include <oneapi/tbb/global_control.h>
#include <system_error>

namespace springtower {
namespace {

constexpr const char* kUnfinishedParts = "validation.unfinished.json";
constexpr Range kValidateThreads{1.0, 1024.0, ""};

constexpr std::string_view kValidateExamples = R"help(examples:
  springtower validate --out validation                 the short form, in less than two minutes
  springtower validate --out validation --full          every tower of every set
  springtower validate --out validation --only pull,tilt --check
parts: verdicts, forces, pull, tilt, loose, scale, sleep, moves. A claim that fails is reported and is no error of the program; with
--check the exit code is then 1. A run that was broken off goes on where it was.)help";

std::vector<ValidationPart> partsOf(const ValidateCommand& command) {
  std::string names;
  for (const ValidationPart& part : validationParts()) names += fmt::format("{}{}", names.empty() ? "" : ", ", part.name);
  for (const std::string& name : command.only) {
    const bool known = std::any_of(validationParts().begin(), validationParts().end(),
                                   [&](const ValidationPart& part) { return part.name == name; });
    if (!known) throw InputError(fmt::format("--only: expected {}, got {}", names, inQuotes(name)));
  }
  std::vector<ValidationPart> parts;
  for (const ValidationPart& part : validationParts()) {
    const bool wanted =
        command.only.empty() || std::find(command.only.begin(), command.only.end(), part.name) != command.only.end();
    if (wanted) parts.push_back(part);
  }
  return parts;
}

void print(const ValidationSection& section, bool isKept) {
  fmt::print("{} ({:.1f} s){}\n", section.title, section.wall_s, isKept ? " (kept)" : "");
  for (const Claim& claim : section.claims) {
    fmt::print("  {:<5}{}: {} (allowed: {})\n", resultOf(claim), claim.what, claim.measured, claim.tolerance);
  }
  for (const std::string& note : section.notes) fmt::print("       {}\n", note);
  std::fflush(stdout);
}

void checkFolders(const ValidationPlan& plan) {
  if (!std::filesystem::is_regular_file(std::filesystem::path(plan.oracle) / "shift.jsonl")) {
    throw InputError(fmt::format("--oracle: expected the folder that holds shift.jsonl, got {}", inQuotes(plan.oracle)));
  }
  if (!std::filesystem::is_regular_file(std::filesystem::path(plan.scenes) / "moves.toml")) {
    throw InputError(fmt::format("--scenes: expected the folder that holds moves.toml, got {}", inQuotes(plan.scenes)));
  }
}

// What an earlier run has left of a part, if its figures are still there; else null.
const ValidationSection* keptSection(const std::vector<KeptPart>& kept, std::string_view name, const std::string& folder) {
  const auto found = std::find_if(kept.begin(), kept.end(), [&](const KeptPart& part) { return part.name == name; });
  if (found == kept.end()) return nullptr;
  for (const ValidationFigure& figure : found->section.figures) {
    for (const char* ending : {".svg", ".png"}) {
      if (!std::filesystem::exists(std::filesystem::path(folder) / (figure.name + ending))) return nullptr;
    }
  }
  return &found->section;
}

// Measures a part and writes its figures.
ValidationSection measured(const ValidationPart& part, const ValidationPlan& plan, const Provenance& provenance,
                           const std::string& folder) {
  const auto start = std::chrono::steady_clock::now();
  ValidationSection section = part.run(plan);
  section.wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  for (ValidationFigure& figure : section.figures) {
    figure.plot.footnote = footnote(provenance);
    writePlot(folder, figure.name, figure.plot);
  }
  return section;
}

}  // namespace

const std::vector<ValidationPart>& validationParts() {
  static const std::vector<ValidationPart> parts = {
      {"verdicts", validateVerdicts}, {"forces", validateForces}, {"pull", validatePulls},  {"tilt", validateTilts},
      {"loose", validateLoose},       {"scale", validateScale},   {"sleep", validateSleep}, {"moves", validateMoves}};
  return parts;
}

CLI::App* defineValidate(CLI::App& program, ValidateCommand& command) {
  CLI::App* validate =
      program.add_subcommand("validate", "compares the simulation with statics and closed forms, claim by claim");
  validate->add_option("--out", command.out, "writes validation.md, validation.json and the figures into this folder")
      ->type_name("DIR")
      ->required();
  CLI::Option* full = validate->add_flag("--full", command.longForm, "all towers of all sets, more seeds: two minutes");
  addFormerFlag(*validate, "--long", full, command.longForm);
  validate->add_option("--only", command.only, "some parts only (see below)")->delimiter(',')->type_name("NAME,...");
  validate->add_option("--oracle", command.oracle, "folder of the reference sets (default tests/data/oracle)")->type_name("DIR");
  validate->add_option("--scenes", command.scenes, "folder of the scene files (default scenes)")->type_name("DIR");
  validate->add_flag("--check", command.check, "exit code 1 if a claim fails");
  CLI::Option* noResume = validate->add_flag("--no-resume", command.noResume,
                                             "measures all parts again, also those that a run that was broken off has left");
  addFormerFlag(*validate, "--fresh", noResume, command.noResume);
  addWholeNumber(*validate, "--threads", command.threads, kValidateThreads, "threads to use (default: one for each processor)");
  wrapDescriptions(*validate);
  validate->footer(std::string(kValidateExamples));
  return validate;
}

int executeValidate(const ValidateCommand& command) {
  const std::vector<ValidationPart> parts = partsOf(command);
  const ValidationPlan plan{command.longForm, command.oracle, command.scenes};
  checkFolders(plan);
  makeOutputFolder(command.out);
  PhysicsOptions options;
  options.threads = command.threads;
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(threadCount(options)));
  const Provenance provenance = provenanceNow();
  const std::string unfinished = (std::filesystem::path(command.out) / kUnfinishedParts).string();
  std::vector<KeptPart> kept;
  if (!command.noResume) kept = readKeptParts(unfinished, plan, provenance);
  std::vector<ValidationSection> sections;
  try {
    for (const ValidationPart& part : parts) {
      const ValidationSection* done = keptSection(kept, part.name, command.out);
      const bool isKept = done != nullptr;
      if (!isKept) {
        std::erase_if(kept, [&](const KeptPart& old) { return old.name == part.name; });
        kept.push_back({std::string(part.name), measured(part, plan, provenance, command.out)});
        writeOutputFile(command.out, kUnfinishedParts,
                        [&](std::ostream& stream) { writeKeptParts(stream, kept, plan, provenance); });
        done = &kept.back().section;
      }
      sections.push_back(*done);
      print(sections.back(), isKept);
    }
  } catch (const Interrupted&) {
    complain("springtower",
             fmt::format("interrupted; {} of {} parts are done and kept in {}", sections.size(), parts.size(), unfinished));
    throw;
  }
  writeOutputFile(command.out, "validation.md",
                  [&](std::ostream& stream) { writeValidationPage(stream, sections, plan, provenance); });
  writeOutputFile(command.out, "validation.json",
                  [&](std::ostream& stream) { writeValidationJson(stream, sections, plan, provenance); });
  // Parts of a run of more parts stay for that.
  if (kept.size() <= parts.size()) std::filesystem::remove(unfinished);
  const ClaimCounts counts = countClaims(sections);
  fmt::print("{} claims hold, {} fail, {} figures are only reported; validation.md in {}\n", counts.passed, counts.failed,
             counts.reported, onOneLine(command.out));
  return command.check && counts.failed > 0 ? 1 : 0;
}

}  // namespace springtower
