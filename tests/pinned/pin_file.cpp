#include "core/error.h"
#include "core/output_file.h"
#include "core/version.h"
#include "tests/pinned/pin.h"

#include <fmt/format.h>
#include <fstream>
#include <nlohmann/json.hpp>

namespace springtower {
namespace {

nlohmann::ordered_json hashesAsJson(const Pin& pin) {
  nlohmann::ordered_json hashes = nlohmann::ordered_json::array();
  for (const std::uint64_t hash : pin.hashes) hashes.push_back(fmt::format("{:016x}", hash));
  return hashes;
}

nlohmann::ordered_json countersAsJson(const Pin& pin) {
  nlohmann::ordered_json counters;
  for (const NamedCounter& counter : kNamedCounters) counters[std::string(counter.name)] = pin.counters.*counter.member;
  return counters;
}

Pin pinFromJson(const nlohmann::json& json) {
  Pin pin;
  for (const nlohmann::json& hash : json.at("hashes")) pin.hashes.push_back(std::stoull(hash.get<std::string>(), nullptr, 16));
  for (const NamedCounter& counter : kNamedCounters)
    pin.counters.*counter.member = json.at("counters").at(std::string(counter.name));
  return pin;
}

}  // namespace

Pins readPins(const std::string& path) {
  std::ifstream file(path);
  if (!file) throw InputError(fmt::format("{}: expected a file of pins, got none", path));
  try {
    Pins pins;
    const nlohmann::json json = nlohmann::json::parse(file);
    for (const auto& [name, scene] : json.at("scenes").items()) pins[name] = pinFromJson(scene);
    return pins;
  } catch (const std::exception& error) {
    throw InputError(fmt::format("{}: expected pins, got none: {}", path, error.what()));
  }
}

void writePins(const std::string& path, const Pins& pins) {
  OutputFile file(path, "--update");
  // The compiler is for information: the bits are the same with any.
  file.stream() << fmt::format("{{\n \"compiler\": \"{}\",\n \"flags\": \"{}\",\n \"scenes\": {{", kCompiler, kCompilerFlags);
  const char* between = "\n";
  for (const auto& [name, pin] : pins) {
    file.stream() << fmt::format("{}  \"{}\": {{\n   \"hashes\": {},\n   \"counters\": {}}}", between, name,
                                 hashesAsJson(pin).dump(), countersAsJson(pin).dump());
    between = ",\n";
  }
  file.stream() << "\n }\n}\n";
  file.commit();
}

}  // namespace springtower
