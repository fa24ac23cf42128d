#pragma once

#include "apps/commands/profile/profile.h"
#include "apps/plot/plot.h"

#include <string>
#include <utility>
#include <vector>

namespace springtower {

/// A chart and the name of its files, without their endings.
using NamedPlot = std::pair<std::string, Plot>;

/// All charts that the results have figures for: rows against frames a second and the stages of a frame for each scene, the
/// report's Figure 6.23 with ours in it, blocks against time for many towers, and the frames of a pull and of a collapse one by
/// one.
std::vector<NamedPlot> profileCharts(const Profile& profile);

}  // namespace springtower
