#include "apps/commands/profile/charts.h"

#include "apps/commands/profile/report_figures.h"
#include "apps/commands/profile/stacks.h"

#include <algorithm>
#include <fmt/format.h>
#include <map>
#include <set>

namespace springtower {
namespace {

constexpr double kScreenRate_hz = 60.0;
constexpr int kReportStyle = 6;  // grey

// A method with its tolerance and threads: one line of a chart.
struct Series {
  std::string method;
  double tolerance_m;
  int threads;
  auto operator<=>(const Series&) const = default;
};

Series seriesOf(const ProfileResult& result) {
  return {result.methodName, result.what.tolerance_m, result.what.threads};
}

// The series of a profile in the order of their first result, so that each has one colour in all charts.
std::vector<Series> allSeries(const Profile& profile) {
  std::vector<Series> all;
  for (const ProfileResult& result : profile.results) {
    if (std::find(all.begin(), all.end(), seriesOf(result)) == all.end()) all.push_back(seriesOf(result));
  }
  return all;
}

// Says only what differs between the series.
std::string nameOf(const Series& series, const std::vector<Series>& all) {
  std::string name = series.method;
  const auto differs = [&](auto member) {
    return std::any_of(all.begin(), all.end(), [&](const Series& other) { return other.*member != series.*member; });
  };
  if (differs(&Series::tolerance_m)) name += fmt::format(", {:g} mm", 1e3 * series.tolerance_m);
  if (differs(&Series::threads)) name += fmt::format(", {} thread{}", series.threads, series.threads == 1 ? "" : "s");
  return name;
}

std::string describe(ProfileScene scene) {
  switch (scene) {
    case ProfileScene::rest:
      return "tower at rest, all blocks awake";
    case ProfileScene::sway:
      return "tower at rest while gravity sways by 0.1 degree at 1 Hz, all blocks awake";
    case ProfileScene::heights:
      return "tower at rest, heights varying by 0.2 mm, all blocks awake";
    case ProfileScene::pull:
      return "a block of the middle row pulled out at 4 cm/s, all blocks awake";
    case ProfileScene::pullSleep:
      return "a block of the middle row pulled out at 4 cm/s, with sleep";
    case ProfileScene::game:
      return "a recorded game: two blocks are drawn out and laid on top, with a third the tower falls";
    case ProfileScene::collapse:
      return "gravity tilted so far that the tower falls";
    case ProfileScene::asleep:
      return "tower asleep";
    case ProfileScene::towers:
      return "many towers at rest, all blocks awake";
    case ProfileScene::pile:
      return "one stack of 108 blocks a row, landing after a fall of 10 cm";
    case ProfileScene::walls:
      return "walls in running bond at rest, all blocks awake";
    case ProfileScene::pyramids:
      return "pyramids of cubes and of bricks at rest, all blocks awake";
    case ProfileScene::starts:
      return "towers that begin in equilibrium, all blocks awake";
    case ProfileScene::topple:
      return "towers that topple, gravity tilted by 14.5 degrees";
    case ProfileScene::hit:
      return "towers that a block flies at with 5 m/s";
    case ProfileScene::heaps:
      return "blocks turned at random that fall into a heap";
    case ProfileScene::piles:
      return "wide stacks of 108 blocks a row, landing after a fall of 10 cm";
    case ProfileScene::rain:
      return "blocks turned at random that land one after the other";
  }
  return "";
}

// What all series have in common, for the line under the title.
std::string commonOf(const std::vector<Series>& all) {
  std::set<double> tolerances;
  std::set<int> threads;
  for (const Series& series : all) {
    tolerances.insert(series.tolerance_m);
    threads.insert(series.threads);
  }
  std::string text;
  if (tolerances.size() == 1) text += fmt::format(", tolerance {:g} mm", 1e3 * *tolerances.begin());
  if (threads.size() == 1) text += fmt::format(", {} thread{}", *threads.begin(), *threads.begin() == 1 ? "" : "s");
  return text;
}

std::string costNote(const Profile& profile) {
  return fmt::format(
      "Frame cost: CPU time on one thread, wall time on more; of each of up to {} frames the least of {} samples, then the "
      "median. ",
      profile.limits.frames, profile.limits.samples);
}

class Charts {
 public:
  explicit Charts(const Profile& profile) : profile_(profile), series_(allSeries(profile)) {
    for (const ProfileResult& result : profile.results) {
      if (result.failure.empty()) byScene_[result.what.scene].push_back(&result);
    }
  }

  std::vector<NamedPlot> all() {
    for (const auto& [scene, results] : byScene_) {
      if (scene != ProfileScene::towers && scene != ProfileScene::game && !isNamed(scene)) rowsAgainstRate(scene, results);
      stages(scene, results);
      if (scene == ProfileScene::pull || scene == ProfileScene::pullSleep || scene == ProfileScene::game ||
          scene == ProfileScene::collapse || scene == ProfileScene::pile) {
        frameByFrame(scene, results);
      }
    }
    if (const auto rest = byScene_.find(ProfileScene::rest); rest != byScene_.end()) figure623(rest->second);
    if (const auto many = byScene_.find(ProfileScene::towers); many != byScene_.end()) manyTowers(many->second);
    stackGrowth();
    depthsOfFalls();
    return std::move(charts_);
  }

 private:
  using Results = std::vector<const ProfileResult*>;

  Plot plot(std::string title, ProfileScene scene) {
    Plot made;
    made.title = std::move(title);
    made.subtitle = describe(scene) + commonOf(series_);
    made.footnote = costNote(profile_) + footnote(profile_.provenance);
    return made;
  }

  // One line for each series that has results.
  template <class Point>
  void addLines(Plot& plot, const Results& results, const Point& point) {
    for (std::size_t i = 0; i < series_.size(); ++i) {
      PlotLine line;
      line.name = nameOf(series_[i], series_);
      line.style = static_cast<int>(i);
      for (const ProfileResult* result : results) {
        if (seriesOf(*result) == series_[i]) line.points.push_back(point(*result));
      }
      std::sort(line.points.begin(), line.points.end(), [](const PlotPoint& a, const PlotPoint& b) { return a.x < b.x; });
      if (!line.points.empty()) plot.lines.push_back(std::move(line));
    }
  }

  void rowsAgainstRate(ProfileScene scene, const Results& results) {
    Plot chart = plot("Rows of the tower against frame rate", scene);
    chart.x = {"rows", false, 0.0};
    chart.y = {"frames a second", true};
    addLines(chart, results, [](const ProfileResult& r) {
      return PlotPoint{static_cast<double>(r.what.rows), r.framesPerSecond()};
    });
    chart.references = {{kReportRate_hz, "12: the report's real time"}, {kScreenRate_hz, "60: a screen's"}};
    charts_.emplace_back(fmt::format("rows_{}", nameOf(scene)), std::move(chart));
  }

  // Stacked stage times over rows (or towers), a chart for each series.
  void stages(ProfileScene scene, const Results& results) {
    for (std::size_t i = 0; i < series_.size(); ++i) {
      Plot chart = plot("Where the time of a frame goes", scene);
      chart.subtitle = fmt::format("{}: {}{}", nameOf(series_[i], series_), describe(scene), commonOf(series_));
      const bool many = scene == ProfileScene::towers;
      chart.x.title = many ? "towers" : isNamed(scene) ? "name and size" : "rows";
      chart.y = {"ms a frame, mean, wall time summed over threads", false, 0.0};
      for (const std::string_view name : kStageNames) {
        std::string label(name);
        std::replace(label.begin(), label.end(), '_', ' ');
        chart.bars.layers.push_back({label, {}});
      }
      double place = 0.0;
      for (const ProfileResult* result : results) {
        if (seriesOf(*result) != series_[i]) continue;
        chart.bars.left.push_back(place - 0.38);
        chart.bars.right.push_back(place + 0.38);
        chart.x.labels.emplace_back(
            place, isNamed(scene) ? result->what.named : fmt::format("{}", many ? result->what.towers : result->what.rows));
        for (std::size_t s = 0; s < kStages; ++s) chart.bars.layers[s].heights.push_back(result->stage_ms[s]);
        place += 1.0;
      }
      if (place == 0.0) continue;
      chart.x.least = -0.6;
      chart.x.most = place - 0.4;
      charts_.emplace_back(fmt::format("stages_{}_{}", nameOf(scene), fileNameOf(i)), std::move(chart));
    }
  }

  // A logarithmic axis, or ours would be out of sight.
  void figure623(const Results& results) {
    Plot chart = plot("The report's Figure 6.23: frame rate against rows in tower", ProfileScene::rest);
    chart.footnote = std::string(kFigure623Note) + " " + chart.footnote;
    chart.x = {"rows", false, 0.0};
    chart.y = {"frames a second", true};
    PlotLine reported{"report, 2003", {}, Marker::hollow, false};
    reported.style = kReportStyle;
    for (const RatePoint& point : kFigure623) reported.points.push_back({point.rows, point.framesPerSecond});
    addLines(chart, results, [](const ProfileResult& r) {
      return PlotPoint{static_cast<double>(r.what.rows), r.framesPerSecond()};
    });
    chart.lines.push_back(std::move(reported));
    chart.references = {{kReportRate_hz, "12: the report's real time"}, {kScreenRate_hz, "60: a screen's"}};
    charts_.emplace_back("figure_6_23", std::move(chart));
  }

  void manyTowers(const Results& results) {
    Plot chart = plot("Many towers: blocks against time", ProfileScene::towers);
    chart.x = {"blocks", true};
    chart.y = {"ms a frame", true};
    addLines(chart, results, [](const ProfileResult& r) { return PlotPoint{static_cast<double>(r.blocks), r.cost().median}; });
    chart.references = {{1e3 / kScreenRate_hz, "16.7 ms: a frame at 60 Hz"}};
    charts_.emplace_back("towers", std::move(chart));
  }

  // A line for each family and number of threads, and Bullet's points hollow.
  void stackGrowth() {
    Plot chart = plot("Walls, pyramids and towers: blocks against time", ProfileScene::walls);
    chart.subtitle = "at rest, all blocks awake" + commonOf(series_);
    chart.x = {"blocks", true};
    chart.y = {"ms a frame", true};
    int style = 0;
    for (const StackFamily& family : stackFamilies()) {
      PlotLine peers{fmt::format("Bullet, {}", family.what), {}, Marker::hollow, false};
      peers.style = style;
      for (std::size_t i = 0; i < series_.size(); ++i) addFamily(family, i, style, chart, peers);
      if (!peers.points.empty()) chart.lines.push_back(std::move(peers));
    }
    if (chart.lines.empty()) return;
    std::string powers;
    for (const StackGrowth& growth : springtower::stackGrowth(profile_)) {
      powers += fmt::format("{}{:.2f} ({}, {} thread{})", powers.empty() ? "Times grow with blocks to the power " : ", ",
                            growth.exponent, familyOf(growth.family).what, growth.threads, growth.threads == 1 ? "" : "s");
    }
    if (!powers.empty()) chart.footnote = powers + ". " + chart.footnote;
    chart.references = {{1e3 / kScreenRate_hz, "16.7 ms: a frame at 60 Hz"}};
    const bool peers = std::any_of(chart.lines.begin(), chart.lines.end(), [](const PlotLine& line) { return !line.joined; });
    if (peers) chart.footnote = "Hollow: Bullet with the steps nearest in depth, so many a frame, CPU time. " + chart.footnote;
    charts_.emplace_back("stacks_growth", std::move(chart));
  }

  // The results of a family in one series, if any, and what another engine made of them.
  void addFamily(const StackFamily& family, std::size_t series, int& style, Plot& chart, PlotLine& peers) {
    const auto scene = byScene_.find(family.scene);
    if (scene == byScene_.end()) return;
    PlotLine line{fmt::format("{}, {}", family.what, nameOf(series_[series], series_)), {}};
    line.style = style;
    for (const ProfileResult* result : scene->second) {
      if (&familyOf(result->what.named) != &family || seriesOf(*result) != series_[series]) continue;
      line.points.push_back({static_cast<double>(result->blocks), result->cost().median});
      const PeerFigures* const peer = nearestInAccuracy(*result);
      if (peer == nullptr) continue;
      peers.points.push_back({static_cast<double>(result->blocks), peer->frame_ms});
      peers.labels.push_back(fmt::format("{}{}", peer->substeps, peer->stands ? "" : ", fell"));
    }
    if (line.points.empty()) return;
    std::sort(line.points.begin(), line.points.end(), [](const PlotPoint& a, const PlotPoint& b) { return a.x < b.x; });
    chart.lines.push_back(std::move(line));
    ++style;
  }

  // Of each fall a chart of time against depth: ours, and another engine's settings hollow, with their steps.
  void depthsOfFalls() {
    std::map<std::string, Plot> charts;
    for (const auto& [scene, results] : byScene_) {
      if (!isFall(scene)) continue;
      for (const ProfileResult* result : results) {
        if (result->what.threads != 1) continue;
        Plot& chart =
            charts.try_emplace(result->what.named, plot("Time against depth: " + result->what.named, scene)).first->second;
        chart.x = {"depth, mm", true};
        chart.y = {"ms a frame", true};
        const std::size_t series = seriesAt(*result);
        PlotLine line{nameOf(series_[series], series_), {{result->penetration_mm, result->cost().median}}};
        line.style = static_cast<int>(series);
        chart.lines.push_back(std::move(line));
        if (result->peers.empty()) continue;
        PlotLine peers{"Bullet, with its steps a frame", {}, Marker::hollow, false};
        peers.style = kReportStyle;
        for (const PeerFigures& peer : result->peers) {
          peers.points.push_back({peer.penetration_mm, peer.frame_ms});
          peers.labels.push_back(fmt::format("{}", peer.substeps));
        }
        chart.lines.push_back(std::move(peers));
      }
    }
    for (auto& [name, chart] : charts) {
      std::string file = "depth_" + name;
      std::replace(file.begin(), file.end(), ':', '_');
      charts_.emplace_back(std::move(file), std::move(chart));
    }
  }

  // Each frame of the tower nearest to the game's 18 rows, and how the frames are spread.
  void frameByFrame(ProfileScene scene, const Results& results) {
    const auto nearest = std::min_element(results.begin(), results.end(), [](const ProfileResult* a, const ProfileResult* b) {
      return std::abs(a->what.rows - 18) < std::abs(b->what.rows - 18);
    });
    const int rows = (*nearest)->what.rows;
    Plot chart = plot(fmt::format("Frame by frame, {} rows", rows), scene);
    chart.x = {"frame", false, 0.0};
    chart.y = {"ms", true};
    for (const ProfileResult* result : results) {
      if (result->what.rows != rows) continue;
      const std::size_t at = seriesAt(*result);
      PlotLine line{nameOf(series_[at], series_), {}, Marker::none};
      line.style = static_cast<int>(at);
      for (std::size_t i = 0; i < result->frame_ms.size(); ++i)
        line.points.push_back({static_cast<double>(i + 1), result->frame_ms[i]});
      chart.lines.push_back(std::move(line));

      Plot spread = plot(fmt::format("How frames are spread, {} rows", rows), scene);
      spread.subtitle = fmt::format("{}: {}{}", nameOf(series_[at], series_), describe(scene), commonOf(series_));
      spread.x = {"ms a frame"};
      spread.y = {"frames", false, 0.0};
      spread.bars = histogram("frames", result->frame_ms, 24);
      charts_.emplace_back(fmt::format("spread_{}_{}", nameOf(scene), fileNameOf(at)), std::move(spread));
    }
    chart.references = {{1e3 / kScreenRate_hz, "16.7 ms: a frame at 60 Hz"}};
    charts_.emplace_back(fmt::format("frames_{}", nameOf(scene)), std::move(chart));
  }

  [[nodiscard]] std::size_t seriesAt(const ProfileResult& result) const {
    return static_cast<std::size_t>(std::find(series_.begin(), series_.end(), seriesOf(result)) - series_.begin());
  }

  [[nodiscard]] std::string fileNameOf(std::size_t series) const {
    std::string name = nameOf(series_[series], series_);
    std::erase_if(name, [](char c) { return c == ','; });
    std::replace(name.begin(), name.end(), ' ', '_');
    return name;
  }

  const Profile& profile_;
  std::vector<Series> series_;
  std::map<ProfileScene, Results> byScene_;
  std::vector<NamedPlot> charts_;
};

}  // namespace

std::vector<NamedPlot> profileCharts(const Profile& profile) {
  return Charts(profile).all();
}

}  // namespace springtower
