#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace springtower {

/// What was found out about one scene. Empty options: not looked at, as the scene was cut short, say.
struct Record {
  std::string scene;  ///< its name
  std::optional<std::uint64_t> seed;
  std::string kind;  ///< of a random scene
  std::string method;
  std::size_t blocks = 0;
  double massRatio = 1.0;  ///< largest over smallest mass
  double leastSide_m = 0.0;
  double tolerance_m = 0.0;  ///< in force

  long frames = 0;
  double simulated_s = 0.0;
  double processor_s = 0.0;  ///< of setting up and of all frames, without what is measured
  bool byHand = false;       ///< a hand plays moves in it
  bool cut = false;          ///< the processor time allowed was over before the scene was
  int mostSubsteps = 0;      ///< of a frame
  std::string diverged;      ///< the message, empty where it did not
  std::string stepLimit;  ///< the message of an explicit method that would need too many steps: no fault, as it is said at once
  std::string notFinite;  ///< what was not a number although nothing was thrown
  std::string refused;    ///< why it was not simulated at all

  double deepest_m = 0.0;     ///< deepest penetration at the end of any frame
  double energyGained = 0.0;  ///< largest rise of the energy above its least value before, less the work of hand and forces,
                              ///< over what there was at the start or was put in
  std::optional<double> momentumLost;  ///< in space: largest change over the sum of what all blocks have
  std::optional<double> angularLost;   ///< the same of angular momentum about the centre of mass
  double movedMost = 0.0;              ///< farthest that the centre of any block was from its start, in its least sides

  std::optional<bool> sameOnTwoThreads;
  std::optional<bool> sameVerdict;    ///< with and without sleep
  std::optional<bool> programAgrees;  ///< `springtower run` on the written scene: exit code, and the hash of the end
  std::string programSays;            ///< where it does not
  std::string hash;                   ///< of the last state
  std::string ended;                  ///< how its process ended, where not by itself: a signal, a limit; empty else
};

/// What can be wrong with a scene. The first five must never be.
enum class Fault : std::uint8_t {
  crash,      ///< its process ended by a signal, or without a record
  refused,    ///< a scene of the generator was not simulated
  notFinite,  ///< NaN or infinity that no error named
  threads,    ///< other states on two threads than on one
  program,    ///< `springtower run` ends otherwise than documented, or with another state
  energy,     ///< energy from nowhere
  diverged,
  hung,  ///< its process was ended at its limit: a frame of one of the runs took too long
  slow,  ///< slower than real time
  deep,
  momentum,
  verdict  ///< other with sleep than without
};
inline constexpr std::array kFaults = {Fault::crash,   Fault::refused, Fault::notFinite, Fault::threads,
                                       Fault::program, Fault::energy,  Fault::diverged,  Fault::hung,
                                       Fault::slow,    Fault::deep,    Fault::momentum,  Fault::verdict};
std::string_view nameOf(Fault fault);

/// The fault of that name. Throws InputError naming `source` and what is allowed.
Fault faultFromName(std::string_view name, std::string_view source);

// From where on it is a fault.
inline constexpr double kMaxEnergyGain = 0.01;
inline constexpr double kMaxEnergyGainByHand = 0.05;  ///< its work is known from its forces at both ends of a frame alone
inline constexpr double kMaxDepthShare = 0.05;        ///< of the scene's least side
inline constexpr double kMaxMomentumLoss = 1e-6;      ///< rounding is below 1e-12
inline constexpr double kMaxAngularLoss = 0.01;       ///< corners go along chords, so steps lose some of a fast spin
inline constexpr double kMaxMove = 0.5;               ///< in least sides of the block: farther, and the scene has not stood

bool has(const Record& record, Fault fault);

/// All of them, in the order of kFaults.
std::vector<Fault> faultsOf(const Record& record);

/// "diverged: block 0 ...": a fault with its numbers, for people. Precondition: the record has it.
std::string describe(const Record& record, Fault fault);

nlohmann::ordered_json recordJson(const Record& record);
/// Back from JSON. Throws nlohmann::json::exception when a key is missing or has another type.
Record recordFromJson(const nlohmann::ordered_json& json);

}  // namespace springtower
