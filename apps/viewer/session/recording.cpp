#include "apps/viewer/session/recording.h"

#include "apps/common/json_values.h"
#include "core/error.h"
#include "core/limits.h"
#include "core/version.h"
#include "scenarios/registry.h"

#include <charconv>
#include <fmt/format.h>
#include <fstream>
#include <nlohmann/json.hpp>
#include <ostream>

namespace springtower {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kFormat = 1;

Json json(const Tuning& tuning) {
  return {{"method", nameOf(tuning.method)},
          {"sleep", nameOf(tuning.sleep)},
          {"tolerance_m", tuning.tolerance_m},
          {"friction", tuning.friction}};
}

Tuning tuningFrom(const Json& json, const std::string& where) {
  Tuning tuning;
  tuning.method = methodFromName(json.at("method").get<std::string>(), where);
  tuning.sleep = sleepFromName(json.at("sleep").get<std::string>(), where);
  tuning.tolerance_m = json.at("tolerance_m").get<double>();
  tuning.friction = json.at("friction").get<double>();
  requireInRange(tuning.friction, kFrictionRange, where + ": friction");
  return tuning;
}

Json json(const Hand& hand) {
  const auto& turn = hand.turn;
  return {{"block", index(hand.block)},
          {"place", {hand.place.x(), hand.place.y(), hand.place.z()}},
          {"turn", {turn.w(), turn.x(), turn.y(), turn.z()}},
          {"limit_n", hand.limit_n}};
}

Hand handFrom(const Json& json, std::size_t blocks, const std::string& where) {
  Hand hand;
  const auto block = json.at("block").get<std::int64_t>();
  if (block < 0 || block >= static_cast<std::int64_t>(blocks)) {
    throw InputError(fmt::format("{}: block: found {}, allowed 0 to {}", where, block, blocks - 1));
  }
  hand.block = blockId(static_cast<std::size_t>(block));
  const auto place = json.at("place").get<std::array<double, 3>>();
  const auto turn = json.at("turn").get<std::array<double, 4>>();
  hand.place = {place[0], place[1], place[2]};
  hand.turn = {turn[0], turn[1], turn[2], turn[3]};
  hand.limit_n = json.at("limit_n").get<double>();
  return hand;
}

template <class T>
void put(Json& json, const char* key, const std::optional<T>& value) {
  if (value) json[key] = *value;
}

template <class T>
std::optional<T> maybe(const Json& json, const char* key) {
  return json.contains(key) ? std::optional<T>(json.at(key).get<T>()) : std::nullopt;
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
  if (json.value("springtower_recording", 0) != kFormat) throw InputError(where + ": this is no recording of the viewer");
  SceneChoice choice;
  choice.name = json.at("scene").get<std::string>();
  if (json.contains("scene_bytes")) {
    const auto bytes = json.at("scene_bytes").get<std::vector<std::uint8_t>>();
    choice.name.assign(bytes.begin(), bytes.end());
  }
  choice.players = json.at("players").get<int>();
  choice.options.heightsSigma_m = maybe<double>(json, "heights_sigma_m");
  choice.options.massSigma_kg = maybe<double>(json, "mass_sigma_kg");
  choice.options.seed = maybe<std::uint64_t>(json, "seed");
  choice.options.startGap_m = maybe<double>(json, "start_gap_m");
  return choice;
}

std::uint64_t hashFrom(const std::string& text, const std::string& where) {
  std::uint64_t hash = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), hash, 16);
  if (error != std::errc{} || end != text.data() + text.size()) {
    throw InputError(fmt::format("{}: hash: found {}, allowed is a hexadecimal number", where, inQuotes(text)));
  }
  return hash;
}

std::string headerLine(const SceneChoice& choice) {
  return jsonText(json(choice)) + '\n';
}

// One frame of a log. The tuning goes with it where it is another than in the frame before.
std::string frameLine(const std::vector<LoggedFrame>& frames, std::size_t i) {
  const LoggedFrame& frame = frames[i];
  Json line = {{"hash", fmt::format("{:016x}", frame.hash)}};
  if (i == 0 || !(frames[i - 1].input.tuning == frame.input.tuning)) line["tuning"] = json(frame.input.tuning);
  if (frame.input.hand.block != kFloor) line["hand"] = json(frame.input.hand);
  return jsonText(line) + '\n';
}

}  // namespace

Scene sceneOf(const SceneChoice& choice) {
  Scene scene = sceneNamed(choice.name, choice.options);
  if (scene.blocks.empty()) throw InputError(choice.name + ": the scene has no blocks, allowed is at least one");
  return scene;
}

void writeRecording(std::ostream& stream, const Recording& recording) {
  stream << headerLine(recording.choice);
  for (std::size_t i = 0; i < recording.frames.size(); ++i) stream << frameLine(recording.frames, i);
}

void RecordingWriter::follow(const SceneChoice& choice, Session& session) {
  if (!file_.canCut()) return;
  const std::string header = headerLine(choice);
  if (header != header_) {
    if (!ends_.empty()) file_.cutTo(0);
    file_.stream() << header;
    header_ = header;
    ends_ = {header.size()};
  } else if (ends_.size() - 1 > session.logKept) {
    ends_.resize(session.logKept + 1);
    file_.cutTo(ends_.back());
  }
  for (std::size_t i = ends_.size() - 1; i < session.log.size(); ++i) {
    const std::string line = frameLine(session.log, i);
    file_.stream() << line;
    ends_.push_back(ends_.back() + line.size());
  }
  session.logKept = session.log.size();
  file_.flushEverySecond();
}

void RecordingWriter::finish(const SceneChoice& choice, Session& session) {
  const std::size_t frames = std::min<std::size_t>(session.frame, session.log.size());
  if (file_.canCut()) {
    follow(choice, session);
    if (frames + 1 < ends_.size()) {
      ends_.resize(frames + 1);
      file_.cutTo(ends_.back());
    }
  } else {
    writeRecording(file_.stream(),
                   {choice, {session.log.begin(), session.log.begin() + static_cast<std::ptrdiff_t>(frames)}, {}});
  }
  file_.commit();
}

Recording readRecording(const std::string& path) {
  std::ifstream stream(path);
  if (!stream) throw InputError(fmt::format("{}: cannot be read", inQuotes(path)));
  Recording recording;
  std::size_t number = 0;
  std::size_t blocks = 0;
  Tuning tuning;
  for (std::string text; std::getline(stream, text);) {
    ++number;
    const std::string where = fmt::format("{}, line {}", onOneLine(path), number);
    try {
      const Json line = Json::parse(text);
      if (number == 1) {
        recording.choice = choiceFrom(line, where);
        blocks = sceneOf(recording.choice).blocks.size();
        continue;
      }
      if (line.contains("tuning")) tuning = tuningFrom(line.at("tuning"), where);
      LoggedFrame frame;
      frame.input.tuning = tuning;
      frame.hash = hashFrom(line.at("hash").get<std::string>(), where);
      if (line.contains("hand")) frame.input.hand = handFrom(line.at("hand"), blocks, where);
      recording.frames.push_back(frame);
    } catch (const Json::parse_error& error) {
      // No end of line, and JSON that lacks its end: the text stops where it was last written.
      const bool brokenOff = stream.eof() && number > 1 && error.byte > text.size();
      if (!brokenOff) throw InputError(fmt::format("{}: {}", where, onOneLine(error.what())));
      recording.missing =
          fmt::format("{}: the line is cut off; the {} frames before it are played", where, recording.frames.size());
    } catch (const Json::exception& error) {
      throw InputError(fmt::format("{}: {}", where, onOneLine(error.what())));
    }
  }
  if (number == 0) throw InputError(fmt::format("{}: found an empty file, allowed is a recording", inQuotes(path)));
  return recording;
}

std::optional<FrameInput> nextInput(const Replay& replay, const Session& session) {
  if (session.frame >= replay.recording.frames.size()) return {};
  return replay.recording.frames[session.frame].input;
}

void compare(Replay& replay, const Session& session) {
  if (replay.differs || session.frame == 0 || session.frame > replay.recording.frames.size()) return;
  const bool same = session.failure.empty() && stateHash(session.simulation) == replay.recording.frames[session.frame - 1].hash;
  if (!same) replay.differs = session.failure.empty() ? session.frame : session.frame + 1;
}

}  // namespace springtower
