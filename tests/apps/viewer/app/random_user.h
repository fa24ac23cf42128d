#pragma once

#include "apps/viewer/view/state.h"
#include "core/random.h"

#include <cstdint>
#include <string>

namespace springtower {

/// Draws what the user does next.
class Dice {
 public:
  explicit Dice(std::uint64_t seed) : random_(seed, 1) {}
  double share() { return random_.uniform(); }
  int below(int n) { return static_cast<int>(n * share()); }
  bool happens(double probability) { return share() < probability; }

 private:
  RandomStream random_;
};

/// Moves the pointer, presses and releases buttons, keys and switches: one of what a user of the viewer may do.
void actAtRandom(Viewer& viewer, Dice& dice);

/// A viewer with uneven blocks that measures penetration.
Viewer randomViewer(const std::string& scene, int players, Method method = Method::semiImplicitEuler);

/// Plays at random for a time, s. Repeats with the same dice.
void playAtRandom(Viewer& viewer, double seconds, Dice& dice);

}  // namespace springtower
