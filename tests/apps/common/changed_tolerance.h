#pragma once

#include <fstream>
#include <string>

namespace springtower {

/// Writes a recording of two frames of 3240 blocks, of which the second begins with another tolerance: another simulation, which
/// searches for its own equilibrium for seconds.
inline void writeChangeOfTolerance(const std::string& path) {
  std::ofstream(path) << R"({"springtower_recording":1,"scene":"pyramid:80","players":0})"
                         "\n"
                      << R"({"tuning":{"method":"implicit","sleep":"on","tolerance_m":5e-05,"friction":0.4}})"
                         "\n"
                      << R"({"tuning":{"method":"implicit","sleep":"on","tolerance_m":1e-05,"friction":0.4}})"
                         "\n";
}

}  // namespace springtower
