#pragma once

#include <string>

namespace CLI {
class App;
class ParseError;
}  // namespace CLI

namespace springtower {

/// What is wrong with a command line that a program could not parse, as a message of one line. Unknown arguments are named in the
/// order in which they were given, each with the option or command that it may have been meant for; what else is wrong is what
/// CLI11 finds, in the same form.
std::string complaintAbout(const CLI::App& program, const CLI::ParseError& error);

/// The number of letters to add, leave out, replace or swap with the next one that turn one word into the other (optimal string
/// alignment distance).
int lettersApart(const std::string& one, const std::string& other);

}  // namespace springtower
