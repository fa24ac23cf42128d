#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace springtower {

/// Why a sleeping block wakes. Every rule of solver/sleep has one.
enum class WakeReason : std::uint8_t {
  gravity,         ///< gravity has changed since the first of the sleepers fell asleep
  force,           ///< a user's force acts on it
  settings,        ///< friction or the sleep rule has been changed between frames
  hand,            ///< a hand holds it
  kick,            ///< its velocity is changed by a kick
  impact,          ///< an awake block is about to hit it, or slides on it fast; or a block it touches is hit
  loadChange,      ///< awake neighbours have changed its load by more than its other contacts support, or a contact came or went
  lostNeighbour,   ///< the sweep has dropped its pair with an awake neighbour
  failedSupport,   ///< it belongs to a group of sleepers whose supports fail under the changed load
  unbalanced,      ///< neighbours fall asleep with other contact forces than those it fell asleep with
  reportedImpact,  ///< method `report`: an impulse acts on it
};
inline constexpr std::size_t kWakeReasons = static_cast<std::size_t>(WakeReason::reportedImpact) + 1;

/// Names in reports.
inline constexpr std::array<std::string_view, kWakeReasons> kWakeReasonNames = {
    "gravity",     "force",          "settings",       "hand",       "kick",           "impact",
    "load_change", "lost_neighbour", "failed_support", "unbalanced", "reported_impact"};

/// How many blocks have woken for each reason.
using WakeCounts = std::array<std::uint64_t, kWakeReasons>;

/// For text output: "force 1, load_change 4"; empty where no block has woken.
inline std::string wakesInWords(const WakeCounts& wakes) {
  std::string words;
  for (std::size_t i = 0; i < kWakeReasons; ++i) {
    if (wakes[i] == 0) continue;
    if (!words.empty()) words += ", ";
    words += std::string(kWakeReasonNames[i]) + ' ' + std::to_string(wakes[i]);
  }
  return words;
}

}  // namespace springtower
