#include "tests/apps/viewer/app/viewer_window.h"

#include <filesystem>
#include <fmt/format.h>
#include <sstream>
#include <stdexcept>

namespace springtower {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kFirstWords = "first picture after ";

ParticleArray readPoses(const std::string& path) {
  std::vector<std::vector<double>> rows;
  for (const std::string& line : linesOf(contentOf(path))) {
    if (line.starts_with("time_s")) continue;
    std::istringstream stream(line);
    std::vector<double> values;
    for (std::string cell; std::getline(stream, cell, ',');) values.push_back(std::stod(cell));
    rows.push_back(values);
  }
  ParticleArray position;
  position.resize(rows.size());
  for (std::size_t b = 0; b < rows.size(); ++b) {
    for (std::size_t c = 0; c < kCorners; ++c) position.set(b, c, {rows[b][2 + 3 * c], rows[b][3 + 3 * c], rows[b][4 + 3 * c]});
  }
  return position;
}

std::vector<std::int32_t> readSeen(const std::string& path) {
  const std::string content = contentOf(path);
  const std::string head = fmt::format("P5\n{} {}\n65535\n", kWindowWidth, kWindowHeight);
  if (!content.starts_with(head)) throw std::runtime_error("not as expected: " + path);
  std::vector<std::int32_t> seen;
  for (std::size_t i = head.size(); i + 1 < content.size(); i += 2) {
    seen.push_back(256 * static_cast<unsigned char>(content[i]) + static_cast<unsigned char>(content[i + 1]) - 1);
  }
  return seen;
}
}  // namespace

Camera Inspection::camera() const {
  const Json& json = report.at("camera");
  Camera camera;
  for (int a = 0; a < 3; ++a) camera.target[a] = json.at("target_m").at(static_cast<std::size_t>(a)).get<double>();
  camera.azimuth = json.at("azimuth").get<double>();
  camera.elevation = json.at("elevation").get<double>();
  camera.distance = json.at("distance_m").get<double>();
  camera.fieldOfView = json.at("field_of_view").get<double>();
  return camera;
}

Window::Window(const std::vector<std::string>& arguments, const Viewport& size, bool waitForPicture)
    : display_(size.width, size.height) {
  std::vector<std::string> all = {
      "--size", fmt::format("{}x{}", size.width, size.height), "--out", scratch_.file("out"), "--report", reportFile()};
  all.insert(all.end(), arguments.begin(), arguments.end());
  program_.emplace("springtower-viewer", all, std::vector<std::string>{display_.variable(), "LIBGL_ALWAYS_SOFTWARE=1"},
                   scratch_.file("log"));
  if (!waitForPicture) {
    act("search --sync --onlyvisible --name springtower-viewer\n");
    return;
  }
  const auto drawn = [&] { return log().starts_with(kFirstWords) && log().ends_with('\n'); };
  if (!waitUntil(60.0, [&] { return drawn() || !program_->runs(); }) || !drawn()) {
    throw std::runtime_error("no picture: " + log());
  }
}

double Window::firstPicture_s() const {
  return std::stod(log().substr(std::string(kFirstWords).size()));
}

std::string Window::inspected(const char* name, const char* ending) const {
  return scratch_.file(fmt::format("out/{}-{:03}{}", name, inspections_, ending));
}

void Window::pressInspect() {
  ++inspections_;
  act("key i");
  if (!waitUntil(60.0, [&] { return std::filesystem::exists(inspected("report", ".json")); })) {
    throw std::runtime_error("no inspection: " + log());
  }
}

Inspection Window::inspect() {
  pressInspect();
  return {Json::parse(contentOf(inspected("report", ".json"))), readPoses(inspected("poses", ".csv")),
          readSeen(inspected("seen", ".pgm"))};
}

nlohmann::json Window::inspectReport() {
  pressInspect();
  return Json::parse(contentOf(inspected("report", ".json")));
}

int Window::end(int signal) {
  program_->send(signal);
  return program_->wait(60.0);
}

int Window::close() {
  act("key Escape");
  return program_->wait(60.0);
}

}  // namespace springtower
