#include "apps/common/provenance.h"

#include "apps/common/output_file.h"
#include "core/error.h"
#include "core/limits.h"
#include "core/version.h"
#include "core/whole_file.h"

#include <chrono>
#include <filesystem>
#include <fmt/chrono.h>
#include <fmt/format.h>
#include <fstream>
#include <nlohmann/json.hpp>
#include <oneapi/tbb/info.h>
#include <system_error>
#include <tuple>

namespace springtower {
namespace {

// Name, family and model of the first processor: machines that are lent often hide all but a brand in the name, and a newer
// generation is a third faster.
std::string processorName() {
  std::ifstream file("/proc/cpuinfo");
  std::string name = "unknown";
  std::string family;
  std::string model;
  for (std::string line; std::getline(file, line) && !line.empty();) {
    const std::size_t colon = line.find(": ");
    if (colon == std::string::npos) continue;
    const std::string key = line.substr(0, line.find_last_not_of("\t :", colon) + 1);
    if (key == "model name") name = line.substr(colon + 2);
    if (key == "cpu family") family = line.substr(colon + 2);
    if (key == "model") model = line.substr(colon + 2);
  }
  return family.empty() ? name : fmt::format("{}, family {} model {}", name, family, model);
}

}  // namespace

Provenance provenanceNow() {
  Provenance now;
  now.version = kVersion;
  now.commit = kGitCommit;
  now.compiler = kCompiler;
  now.flags = kCompilerFlags;
  now.buildType = kBuildType;
  now.processor = processorName();
  now.processors = static_cast<unsigned>(tbb::info::default_concurrency());
  now.date =
      fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(std::chrono::system_clock::to_time_t(std::chrono::system_clock::now())));
  return now;
}

nlohmann::ordered_json provenanceJson(const Provenance& provenance) {
  return {{"version", provenance.version},       {"commit", provenance.commit},
          {"compiler", provenance.compiler},     {"flags", provenance.flags},
          {"build_type", provenance.buildType},  {"cpu", provenance.processor},
          {"processors", provenance.processors}, {"date", provenance.date}};
}

Provenance provenanceFromJson(const nlohmann::ordered_json& json) {
  Provenance provenance;
  json.at("version").get_to(provenance.version);
  json.at("commit").get_to(provenance.commit);
  json.at("compiler").get_to(provenance.compiler);
  json.at("flags").get_to(provenance.flags);
  json.at("build_type").get_to(provenance.buildType);
  json.at("cpu").get_to(provenance.processor);
  json.at("processors").get_to(provenance.processors);
  json.at("date").get_to(provenance.date);
  return provenance;
}

bool sameOrigin(const Provenance& a, const Provenance& b) {
  const auto origin = [](const Provenance& p) {
    return std::tie(p.version, p.commit, p.compiler, p.flags, p.buildType, p.processor);
  };
  return origin(a) == origin(b);
}

void checkCommitted(const Provenance& then, const Provenance& now, const std::string& where) {
  const auto why = [](const Provenance& build) {
    if (build.commit == "unknown") return "was built outside a git clone";
    return build.commit.ends_with("-dirty") ? "has uncommitted changes" : nullptr;
  };
  const char* ours = why(now);
  const char* reason = ours != nullptr ? ours : why(then);
  if (reason == nullptr) return;
  throw InputError(
      fmt::format("{}: expected results of builds of a commit, or --no-resume, got others: {} {}, so that its commit does not "
                  "say whether they are of the same sources",
                  where, ours != nullptr ? "this build" : "the build that measured them", reason));
}

void readKept(const std::string& path, const Provenance& now, const nlohmann::ordered_json& settings,
              const std::function<void(const nlohmann::ordered_json&)>& read) {
  std::error_code missing;
  if (!std::filesystem::exists(path, missing)) return;
  const std::string text = wholeFile(path, onOneLine(path), kMaxResultsBytes);
  try {
    const auto json = nlohmann::ordered_json::parse(text);
    const Provenance then = provenanceFromJson(json);
    checkCommitted(then, now, "kept results");
    bool same = sameOrigin(then, now);
    for (const auto& [key, value] : settings.items()) same = same && json.at(key) == value;
    if (!same) throw InputError("expected results of this run, or --no-resume, got those of another build, machine or options");
    read(json);
  } catch (const nlohmann::json::exception& error) {
    throw InputError(fmt::format("{}: expected what an earlier run of this version leaves, or --no-resume, got other content: {}",
                                 onOneLine(path), onOneLine(error.what())));
  } catch (const InputError& error) {
    throw InputError(fmt::format("{}: {}", onOneLine(path), error.what()));
  }
}

std::string csvText(const Provenance& provenance) {
  return fmt::format("{},{},{},{},{}", provenance.commit, csvText(provenance.compiler), csvText(provenance.flags),
                     csvText(provenance.processor), provenance.date);
}

std::string footnote(const Provenance& provenance) {
  return fmt::format("springtower {}, commit {}, {}; {}, {} processor{}; {}, {} {}", provenance.version, provenance.commit,
                     provenance.date, provenance.processor, provenance.processors, provenance.processors == 1 ? "" : "s",
                     provenance.compiler, provenance.buildType, provenance.flags);
}

}  // namespace springtower
