#pragma once

#include "apps/commands/profile/command.h"
#include "apps/commands/profile/profile.h"

#include <vector>

namespace springtower {

/// How long to prepare and to measure, by the options.
ProfileLimits limitsOf(const ProfileCommand& command);

/// All combinations of the options, scene by scene; threads vary fastest, so that they share their preparation. Throws InputError
/// naming the option, what is expected and what it got.
std::vector<ProfileCase> casesOf(const ProfileCommand& command);

}  // namespace springtower
