#pragma once

#include <fstream>
#include <string>

namespace springtower {

/// Writes a recording of two frames, of which the second begins with another tolerance: another simulation, which searches for
/// its own equilibrium, for seconds where that of the scene takes so long. The usual scene has 3240 blocks in one island.
inline void writeChangeOfTolerance(const std::string& path, const std::string& scene = "pyramid:80") {
  std::ofstream(path) << R"({"springtower_recording":1,"scene":")" << scene << R"(","players":0})"
                      << "\n"
                      << R"({"tuning":{"method":"implicit","sleep":"on","tolerance_m":5e-05,"friction":0.4}})"
                         "\n"
                      << R"({"tuning":{"method":"implicit","sleep":"on","tolerance_m":1e-05,"friction":0.4}})"
                         "\n";
}

}  // namespace springtower
