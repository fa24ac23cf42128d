#include "core/settings.h"

#include "core/error.h"
#include "core/limits.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <fmt/format.h>
#include <utility>

namespace springtower {
namespace {

// A key, its unit and reason, its least and largest value (0 and 1 for off and on).
constexpr auto kSettingTable = std::to_array<SettingRow>({
    {"frame_s", "s", "simulated time of a frame; the default is that of a screen of 60 Hz", 1e-4, 0.1, &Settings::frame_s},
    {"tolerance_m", "m",
     "target penetration: no resting overlap and no row compression exceeds it; a smaller one means stiffer blocks; by default "
     "in proportion to the block height",
     1e-7, 1e-2, &Settings::tolerance_m},
    {"substeps", "", "steps in a frame; 0 takes as many as the tolerance needs", 0, 100000, &Settings::substeps},
    {"allow_unstable", "", "runs a tolerance and substeps that do not fit together, to see what then happens", 0, 1,
     &Settings::allowUnstable},
    {"stability_safety", "", "part of the stability limit that a step uses; the rest covers contacts that change within a step",
     0.05, 1, &Settings::stabilitySafety},
    {"spring_ratio", "",
     "stiffness of an upright edge spring over that of a contact; explicit methods raise it where the speeds at the start need "
     "more",
     0.01, 100, &Settings::springRatio},
    {"tangential_ratio", "", "tangential over normal stiffness of a contact; 2 (1 - nu) / (2 - nu) for elastic bodies (Mindlin)",
     0.01, 2, &Settings::tangentialRatio},
    {"maxwell_ratio", "",
     "stiffness of a contact's Maxwell branch over that of its spring; the branch relaxes and damps the slow sway of a tower", 0,
     2, &Settings::maxwellRatio},
    {"maxwell_time", "sqrt(h / g)", "relaxation time of that branch; near the period of the sway it damps most", 1e-3, 25,
     &Settings::maxwellTime},
    {"stiffness_damping", "sqrt(h / g)",
     "dashpot over stiffness of springs and contacts (Rayleigh's beta); sets how high a dropped block rebounds", 0, 0.25,
     &Settings::stiffnessDamping},
    {"impact_depth", "", "largest penetration aimed at in an impact, in tolerances (not less than the default one)", 1, 1000,
     &Settings::impactDepth},
    {"continuous_tests", "", "finds collisions by the cubic tests; off, blocks that come together go through each other", 0, 1,
     &Settings::continuousTests},
    {"sleep_speed", "sqrt(g h)", "a block slower than this may be at rest", 0, 1, &Settings::sleepSpeed},
    {"sleep_time", "sqrt(h / g)", "for how long a block is slower than sleep_speed before it sleeps", 0, 1e6,
     &Settings::sleepTime},
    {"sleep_imbalance", "block weights", "largest mean force (or torque over h) on a block that counts as balanced", 0, 1,
     &Settings::sleepImbalance},
    {"report_restitution", "", "method report: e of its impulses", 0, 1, &Settings::reportRestitution},
    {"report_friction_drag", "1/s", "method report: drag on contact points for each unit of a particle's mass", 0, 1000,
     &Settings::reportFrictionDrag},
    {"report_disable_distance_m", "m", "with sleep = \"report\": a block whose particles travel less in a frame is disabled", 0,
     1, &Settings::reportDisableDistance_m},
    {"report_iterations", "", "method report: most iterations of its collision loop in a step", 1, 1000,
     &Settings::reportIterations},
    {"iterations", "", "rigid methods: iterations over the contacts in a substep; taller towers need more of them", 1, 1000,
     &Settings::iterations},
});

constexpr auto kSettingAliases = std::to_array<SettingAlias>({{"force_unstable", "allow_unstable"},
                                                              {"step_margin", "stability_safety"},
                                                              {"viscoelastic_ratio", "maxwell_ratio"},
                                                              {"viscoelastic_time", "maxwell_time"},
                                                              {"damping_time", "stiffness_damping"},
                                                              {"impact_penetration", "impact_depth"},
                                                              {"rest_speed", "sleep_speed"},
                                                              {"rest_time", "sleep_time"},
                                                              {"rest_imbalance", "sleep_imbalance"}});

template <class T>
using Names = std::span<const std::pair<std::string_view, T>>;

constexpr auto kMethodNames =
    std::to_array<std::pair<std::string_view, Method>>({{"implicit", Method::implicit},
                                                        {"implicit-euler", Method::implicitEuler},
                                                        {"implicit-eigen", Method::implicitEigen},
                                                        {"semi-implicit-euler", Method::semiImplicitEuler},
                                                        {"midpoint", Method::midpoint},
                                                        {"runge-kutta-4", Method::rungeKutta4},
                                                        {"report", Method::report},
                                                        {"rigid-pgs", Method::rigidPgs},
                                                        {"rigid-lcp", Method::rigidLcp},
                                                        {"xpbd", Method::xpbd},
                                                        {"auto", Method::automatic}});
// Read, never written: reports, recordings and CSV files of all versions have one name for a method.
constexpr auto kMethodAliases = std::to_array<std::pair<std::string_view, Method>>(
    {{"bdf2", Method::implicit}, {"bdf2-eigen", Method::implicitEigen}, {"legacy-2003", Method::report}});
constexpr std::array<std::pair<std::string_view, Inertia>, 2> kInertiaNames = {
    {{"cuboid", Inertia::cuboid}, {"lumped", Inertia::lumped}}};
constexpr std::array<std::pair<std::string_view, Sleep>, 3> kSleepNames = {
    {{"off", Sleep::off}, {"on", Sleep::on}, {"report", Sleep::report}}};

template <class T>
T valueOf(Names<T> names, std::string_view name, std::string_view source, Names<T> aliases = {}) {
  for (const auto& [alias, named] : aliases) {
    if (alias == name) return named;
  }
  std::string allowed;
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (names[i].first == name) return names[i].second;
    allowed += fmt::format("{}{}", i == 0 ? "" : i + 1 == names.size() ? " or " : ", ", names[i].first);
    for (const auto& [alias, named] : aliases) {
      if (named == names[i].second) allowed += fmt::format(" (also: {})", alias);
    }
  }
  throw InputError(fmt::format("{}: expected {}, got {}", source, allowed, inQuotes(name)));
}

template <class T>
std::string_view nameIn(Names<T> names, T value) {
  for (const auto& [name, named] : names) {
    if (named == value) return name;
  }
  return "unknown";
}

}  // namespace

std::span<const SettingRow> settingTable() {
  return kSettingTable;
}

std::span<const SettingAlias> settingAliases() {
  return kSettingAliases;
}

std::string_view formerKeyOf(std::string_view key) {
  for (const SettingAlias& alias : kSettingAliases) {
    if (alias.key == key) return alias.formerKey;
  }
  return {};
}

std::optional<double> numberOf(const Settings& settings, const SettingRow& row) {
  if (const auto* optional = std::get_if<std::optional<double> Settings::*>(&row.member)) return settings.**optional;
  if (const auto* number = std::get_if<double Settings::*>(&row.member)) return settings.**number;
  if (const auto* whole = std::get_if<int Settings::*>(&row.member)) return settings.**whole;
  return settings.*std::get<bool Settings::*>(row.member) ? 1.0 : 0.0;
}

void checkSettings(const Settings& settings, std::string_view source) {
  for (const SettingRow& row : settingTable()) {
    const std::optional<double> value = numberOf(settings, row);
    if (value) requireInRange(*value, {row.least, row.most, row.unit}, fmt::format("{}: {}", source, row.key));
  }
}

Method methodFromName(std::string_view name, std::string_view source) {
  return valueOf<Method>(kMethodNames, name, source, kMethodAliases);
}
bool isNameOf(std::string_view name, Method method) {
  const auto reads = [&](const auto& entry) { return entry.first == name && entry.second == method; };
  return std::ranges::any_of(kMethodNames, reads) || std::ranges::any_of(kMethodAliases, reads);
}
Inertia inertiaFromName(std::string_view name, std::string_view source) {
  return valueOf<Inertia>(kInertiaNames, name, source);
}
Sleep sleepFromName(std::string_view name, std::string_view source) {
  return valueOf<Sleep>(kSleepNames, name, source);
}
std::string_view nameOf(Method method) {
  return nameIn<Method>(kMethodNames, method);
}
std::string_view nameOf(Inertia inertia) {
  return nameIn<Inertia>(kInertiaNames, inertia);
}
std::string_view nameOf(Sleep sleep) {
  return nameIn<Sleep>(kSleepNames, sleep);
}

}  // namespace springtower
