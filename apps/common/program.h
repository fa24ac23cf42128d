#pragma once

#include <functional>
#include <string>
#include <string_view>

namespace springtower {

// What the programs' `main` have in common. Exit codes: 0 done, 2 bad input or arguments, or no place for the output, 3 diverged,
// 70 an error of the program itself, 130 and 143 ended by SIGINT and SIGTERM; others are the program's own.
inline constexpr int kBadInput = 2;
inline constexpr int kDiverged = 3;
inline constexpr int kProgramError = 70;

/// Says on standard error, in one line, what is wrong. Throws nothing: where standard error takes nothing it is lost.
void complain(std::string_view program, const std::string& message);

/// Does the work of a program and returns its exit code: what the work returned, or that of what it threw, after a complaint.
/// From here on signals are noted (interruption.h), and a closed pipe is an error of writing. Output that standard
/// output does not take, as it is closed or its disk full, ends in 2, whatever the work returned and after a signal as well; only
/// what diverged (3) and an error of the program itself (70) keep their codes. A complaint that standard error does not take is
/// lost and changes no code; of other text for it the error ends in 2 where the work throws it. Throws nothing.
int exitCodeOf(std::string_view program, const std::function<int()>& work);

}  // namespace springtower
