#pragma once

#include "tests/random/record.h"

#include <span>
#include <string>
#include <vector>

namespace springtower {

/// What share of random scenes may have a fault today, and why.
struct Bound {
  Fault fault;
  double rate;              ///< at most; 0: no scene may ever
  std::string_view reason;  ///< what it was measured on, and what is behind it
};

/// One for each fault.
std::span<const Bound> bounds();

/// The probability that a gate of random scenes fails although the rate of its bound holds.
inline constexpr double kFalseAlarm = 1e-6;

/// The least count that more scenes of `scenes` have with a probability below `falseAlarm`, where each has the fault with
/// probability `rate` on its own (binomial distribution). 0 where the rate is 0. Preconditions: rate in [0, 1), falseAlarm in
/// (0, 1), scenes not negative.
int mostAllowed(double rate, int scenes, double falseAlarm = kFalseAlarm);

/// The records by kind, by method, by ratio of masses, and implicit methods by ratio: how many there are, and how many have each
/// fault; then, which are no faults, how many were cut off at their limit of processor time, of which the faults are those of the
/// part played, and how many an explicit method refused as it would need too many steps. Lines for people.
std::string tableOf(std::span<const Record> records);

/// Every fault with its count, what is allowed, and the seeds, worst first (at most 12).
std::string faultLines(std::span<const Record> records);

/// The faults that more records have than their bounds allow; of implicit and auto no scene may diverge. Those of processor time
/// are left out where `judgeTimes` is false: sanitizers and builds without optimisation are slower by what has nothing to do with
/// the engine.
std::vector<Fault> exceededBounds(std::span<const Record> records, bool judgeTimes);

}  // namespace springtower
