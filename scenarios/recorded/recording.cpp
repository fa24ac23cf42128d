#include "scenarios/recorded/recording.h"

#include "core/error.h"
#include "core/limits.h"
#include "core/line_input.h"
#include "core/scene/input_check.h"
#include "core/tuning.h"
#include "core/version.h"
#include "scenarios/registry.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdint>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <initializer_list>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <ostream>
#include <stdexcept>
#include <string_view>
#include <utility>

namespace springtower {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kFormat = 1;
constexpr double kTurnError = 1e-9;             // of the length of a unit quaternion
constexpr Range kRateRange{1.0, 1e4, "rad/s"};  // of the hand's spring
constexpr std::int64_t kMostBytes = 4096;       // of a file's name
constexpr std::int64_t kMostWhole = std::numeric_limits<std::int64_t>::max();

Json json(const Tuning& tuning) {
  return {{"method", nameOf(tuning.method)},
          {"sleep", nameOf(tuning.sleep)},
          {"tolerance_m", tuning.tolerance_m},
          {"friction", tuning.friction}};
}

// A value as messages name it. Arrays and objects are not printed: they may be as deep as they like.
std::string shown(const Json& value) {
  if (value.is_structured()) return fmt::format("an {}", value.type_name());
  if (value.is_number()) return value.dump();
  return inQuotes(value.dump(-1, ' ', true, Json::error_handler_t::replace));
}

// The value of a key. Every number is checked here: a cast of one that is out of its type's range is undefined.
const Json& valueOf(const Json& json, const char* key, const std::string& where) {
  if (!json.is_object()) throw InputError(fmt::format("{}: expected an object, got {}", where, shown(json)));
  if (!json.contains(key)) throw InputError(fmt::format("{}: expected the key {}, got none", where, key));
  return json.at(key);
}

// What is misspelt would be left out: a frame without its hand, say.
void refuseOtherKeys(const Json& json, std::initializer_list<std::string_view> known, const std::string& where) {
  if (!json.is_object()) throw InputError(fmt::format("{}: expected an object, got {}", where, shown(json)));
  for (const auto& [key, value] : json.items()) {
    if (std::find(known.begin(), known.end(), key) == known.end())
      throw InputError(fmt::format("{}: expected {}, got the unknown key {}", where, fmt::join(known, ", "), inQuotes(key)));
  }
}

double numberOf(const Json& value, const Range& range, const std::string& where) {
  if (!value.is_number() || !isInside(value.get<double>(), range))
    throw InputError(fmt::format("{}: expected a number from {}, got {}", where, describe(range), shown(value)));
  return value.get<double>();
}

double number(const Json& json, const char* key, const Range& range, const std::string& where) {
  return numberOf(valueOf(json, key, where), range, fmt::format("{}: {}", where, key));
}

std::int64_t wholeNumberOf(const Json& value, std::int64_t most, const std::string& where) {
  const bool isWhole = value.is_number_unsigned() || (value.is_number_integer() && value.get<std::int64_t>() >= 0);
  if (!isWhole || value.get<std::uint64_t>() > static_cast<std::uint64_t>(most))
    throw InputError(fmt::format("{}: expected a whole number from 0 to {}, got {}", where, most, shown(value)));
  return value.get<std::int64_t>();
}

std::int64_t wholeNumber(const Json& json, const char* key, std::int64_t most, const std::string& where) {
  return wholeNumberOf(valueOf(json, key, where), most, fmt::format("{}: {}", where, key));
}

std::string text(const Json& json, const char* key, const std::string& where) {
  const Json& value = valueOf(json, key, where);
  if (!value.is_string()) throw InputError(fmt::format("{}: {}: expected a text, got {}", where, key, shown(value)));
  return value.get<std::string>();
}

template <std::size_t kCount>
std::array<double, kCount> numbers(const Json& json, const char* key, const Range& range, const std::string& where) {
  const Json& values = valueOf(json, key, where);
  if (!values.is_array() || values.size() != kCount)
    throw InputError(fmt::format("{}: {}: expected {} numbers, got {}", where, key, kCount, shown(values)));
  std::array<double, kCount> read{};
  for (std::size_t i = 0; i < kCount; ++i) read[i] = numberOf(values[i], range, fmt::format("{}: {}[{}]", where, key, i));
  return read;
}

Range rangeOfTolerance() {
  for (const SettingRow& row : settingTable()) {
    if (row.key == "tolerance_m") return {row.least, row.most, row.unit};
  }
  throw std::logic_error("no setting tolerance_m");
}

Tuning tuningFrom(const Json& json, const std::string& where) {
  refuseOtherKeys(json, {"method", "sleep", "tolerance_m", "friction"}, where);
  Tuning tuning;
  tuning.method = methodFromName(text(json, "method", where), where);
  tuning.sleep = sleepFromName(text(json, "sleep", where), where);
  tuning.tolerance_m = number(json, "tolerance_m", rangeOfTolerance(), where);
  tuning.friction = number(json, "friction", kFrictionRange, where);
  return tuning;
}

Json json(const Hand& hand) {
  const auto& turn = hand.turn;
  Json json = {{"block", index(hand.block)},
               {"place", {hand.place.x(), hand.place.y(), hand.place.z()}},
               {"turn", {turn.w(), turn.x(), turn.y(), turn.z()}},
               {"limit_n", hand.limit_n}};
  // What is as usual is left out, so that a frame in which the hand rests takes one short line.
  if (!hand.velocity.isZero(0.0)) json["velocity"] = {hand.velocity.x(), hand.velocity.y(), hand.velocity.z()};
  if (!hand.line.isZero(0.0)) json["line"] = {hand.line.x(), hand.line.y(), hand.line.z()};
  if (hand.rate_rad_s != tuning::kFollowFrequency_rad_s) json["rate_rad_s"] = hand.rate_rad_s;
  return json;
}

Hand handFrom(const Json& json, const Scene& scene, const std::string& where) {
  refuseOtherKeys(json, {"block", "place", "turn", "limit_n", "velocity", "line", "rate_rad_s"}, where);
  Hand hand;
  const auto last = static_cast<std::int64_t>(scene.blocks.size()) - 1;
  const auto block = static_cast<std::size_t>(wholeNumber(json, "block", last, where));
  requireMovable(scene, block, where + ": block");
  hand.block = blockId(block);
  const auto place = numbers<3>(json, "place", kPlaceRange, where);
  const auto turn = numbers<4>(json, "turn", {-1.0 - kTurnError, 1.0 + kTurnError, ""}, where);
  hand.place = {place[0], place[1], place[2]};
  hand.turn = {turn[0], turn[1], turn[2], turn[3]};
  requireInRange(hand.turn.norm(), {1.0 - kTurnError, 1.0 + kTurnError, ""}, where + ": turn: length of the quaternion");
  hand.limit_n = number(json, "limit_n", kHandForceRange, where);
  if (json.contains("velocity")) {
    const auto velocity = numbers<3>(json, "velocity", kVelocityRange, where);
    hand.velocity = {velocity[0], velocity[1], velocity[2]};
  }
  if (json.contains("line")) {
    const auto line = numbers<3>(json, "line", {-1.0 - kTurnError, 1.0 + kTurnError, ""}, where);
    hand.line = {line[0], line[1], line[2]};
    requireInRange(hand.line.norm(), {1.0 - kTurnError, 1.0 + kTurnError, ""}, where + ": line: length");
  }
  if (json.contains("rate_rad_s")) hand.rate_rad_s = number(json, "rate_rad_s", kRateRange, where);
  return hand;
}

std::string lineOf(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace) + '\n';
}

// Whether a text can stand in JSON as it is.
bool isUtf8(const std::string& text) {
  try {
    return !Json(text).dump().empty();
  } catch (const Json::type_error&) {
    return false;
  }
}

template <class T>
void put(Json& json, const char* key, const std::optional<T>& value) {
  if (value) json[key] = *value;
}

void readIfThere(const Json& json, const char* key, const Range& range, const std::string& where, std::optional<double>& target) {
  if (json.contains(key)) target = number(json, key, range, where);
}

Json json(const SceneChoice& choice) {
  Json json = {{"springtower_recording", kFormat}, {"version", kVersion}, {"scene", choice.name}, {"players", choice.players}};
  // JSON holds no bytes that are not UTF-8, and the file has to be found again.
  if (!isUtf8(choice.name)) json["scene_bytes"] = std::vector<std::uint8_t>(choice.name.begin(), choice.name.end());
  put(json, "heights_sigma_m", choice.options.heightsSigma_m);
  put(json, "mass_sigma_kg", choice.options.massSigma_kg);
  put(json, "seed", choice.options.seed);
  put(json, "start_gap_m", choice.options.startGap_m);
  return json;
}

SceneChoice choiceFrom(const Json& json, const std::string& where) {
  if (!json.is_object() || !json.contains("springtower_recording") || json.at("springtower_recording") != kFormat)
    throw InputError(where + ": expected a recording of the viewer, got none");
  refuseOtherKeys(json,
                  {"springtower_recording", "version", "scene", "scene_bytes", "players", "heights_sigma_m", "mass_sigma_kg",
                   "seed", "start_gap_m"},
                  where);
  SceneChoice choice;
  choice.name = text(json, "scene", where);
  if (json.contains("scene_bytes")) {
    const Json& bytes = json.at("scene_bytes");
    if (!bytes.is_array() || bytes.size() > static_cast<std::size_t>(kMostBytes))
      throw InputError(fmt::format("{}: scene_bytes: expected up to {} whole numbers, got {}", where, kMostBytes, shown(bytes)));
    choice.name.clear();
    for (const Json& byte : bytes)
      choice.name += static_cast<char>(static_cast<unsigned char>(wholeNumberOf(byte, 255, where + ": scene_bytes")));
  }
  choice.players = static_cast<int>(wholeNumber(json, "players", kMaxPlayers, where));
  readIfThere(json, "heights_sigma_m", kHeightsSigmaRange, where, choice.options.heightsSigma_m);
  readIfThere(json, "mass_sigma_kg", kMassSigmaRange, where, choice.options.massSigma_kg);
  if (json.contains("seed")) choice.options.seed = static_cast<std::uint64_t>(wholeNumber(json, "seed", kMostWhole, where));
  readIfThere(json, "start_gap_m", kStartGapRange, where, choice.options.startGap_m);
  return choice;
}

std::uint64_t hashFrom(const std::string& text, const std::string& where) {
  std::uint64_t hash = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), hash, 16);
  if (error != std::errc{} || end != text.data() + text.size()) {
    throw InputError(fmt::format("{}: hash: expected a hexadecimal number, got {}", where, inQuotes(text)));
  }
  return hash;
}

// As the header of a recording has it. Throws InputError naming where it stands.
Scene sceneOf(const SceneChoice& choice, const std::string& where) {
  try {
    return sceneOf(choice);
  } catch (const InputError& error) {
    throw InputError(fmt::format("{}: scene: {}", where, error.what()));
  }
}

LoggedFrame frameFrom(const Json& line, const Scene& scene, const Tuning& before, const std::string& where) {
  refuseOtherKeys(line, {"hash", "tuning", "hand"}, where);
  LoggedFrame frame;
  if (line.contains("hash")) frame.hash = hashFrom(text(line, "hash", where), where);
  frame.input.tuning = line.contains("tuning") ? tuningFrom(line.at("tuning"), where) : before;
  if (line.contains("hand")) frame.input.hand = handFrom(line.at("hand"), scene, where);
  return frame;
}

// Reads a recording line by line.
class RecordingReader {
 public:
  // Throws InputError naming where the line stands; Json::parse_error where it is no JSON.
  void take(std::string_view text, const std::string& where) {
    try {
      const Json line = Json::parse(text);
      if (!scene_) return begin(line, where);
      recording.frames.push_back(frameFrom(line, *scene_, tuning_, where));
      tuning_ = recording.frames.back().input.tuning;
    } catch (const Json::parse_error&) {
      throw;
    } catch (const Json::exception& error) {  // also a number that is too large
      throw InputError(fmt::format("{}: {}", where, onOneLine(error.what())));
    }
  }
  [[nodiscard]] bool begun() const { return scene_.has_value(); }

  Recording recording;

 private:
  void begin(const Json& line, const std::string& where) {
    recording.choice = choiceFrom(line, where);
    scene_ = sceneOf(recording.choice, where);
    tuning_ = tuningOf(*scene_);
  }

  std::optional<Scene> scene_;
  Tuning tuning_;
};

}  // namespace

Scene sceneOf(const SceneChoice& choice) {
  Scene scene = sceneNamed(choice.name, choice.options);
  if (scene.blocks.empty()) throw InputError(choice.name + ": expected a scene with at least one block, got none");
  return scene;
}

Tuning tuningOf(const Scene& scene) {
  return {scene.settings.method, scene.settings.sleep, toleranceOf(scene), scene.staticFriction};
}

Scene withTuning(Scene scene, const Tuning& tuning) {
  const Tuning own = tuningOf(scene);
  scene.settings.method = tuning.method;
  scene.settings.sleep = tuning.sleep;
  if (tuning.tolerance_m != own.tolerance_m) {
    scene.settings.tolerance_m = tuning.tolerance_m;
    scene.settings.substeps = 0;
  }
  // A scene may give two coefficients; they stay two until the user sets one.
  if (tuning.friction != own.friction) {
    scene.staticFriction = tuning.friction;
    scene.kineticFriction = tuning.friction;
  }
  return scene;
}

std::string headerLine(const SceneChoice& choice) {
  return lineOf(json(choice));
}

std::string frameLine(const std::vector<LoggedFrame>& frames, std::size_t i) {
  const LoggedFrame& frame = frames[i];
  Json line = Json::object();
  if (frame.hash) line["hash"] = fmt::format("{:016x}", *frame.hash);
  if (i == 0 || !(frames[i - 1].input.tuning == frame.input.tuning)) line["tuning"] = json(frame.input.tuning);
  if (frame.input.hand.block != kFloor) line["hand"] = json(frame.input.hand);
  return lineOf(line);
}

void writeRecording(std::ostream& stream, const Recording& recording) {
  stream << headerLine(recording.choice);
  for (std::size_t i = 0; i < recording.frames.size(); ++i) stream << frameLine(recording.frames, i);
}

Recording readRecording(const std::string& path) {
  LineInput input(path);
  RecordingReader reader;
  for (std::string text; input.next(text);) {
    try {
      reader.take(text, input.where());
    } catch (const Json::parse_error& error) {
      // No end of line, and JSON that lacks its end: the text stops where it was last written.
      const bool brokenOff = input.endedWithFile() && reader.begun() && error.byte > text.size();
      if (!brokenOff) throw InputError(fmt::format("{}: {}", input.where(), onOneLine(error.what())));
      reader.recording.missing = fmt::format("{}: the line is cut off; the {} frames before it are played", input.where(),
                                             reader.recording.frames.size());
    }
  }
  if (!reader.begun()) throw InputError(fmt::format("{}: expected a recording, got an empty file", onOneLine(path)));
  return std::move(reader.recording);
}

Recording recordingOf(std::span<const std::string_view> lines, const std::string& name) {
  RecordingReader reader;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const std::string where = fmt::format("{}, line {}", name, i + 1);
    try {
      reader.take(lines[i], where);
    } catch (const Json::parse_error& error) {
      throw InputError(fmt::format("{}: {}", where, onOneLine(error.what())));
    }
  }
  if (!reader.begun()) throw InputError(fmt::format("{}: expected a recording, got no line", name));
  return std::move(reader.recording);
}

}  // namespace springtower
