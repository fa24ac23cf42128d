#include "apps/common/arguments.h"

#include "core/limits.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstddef>
#include <fmt/format.h>
#include <regex>
#include <utility>
#include <vector>

namespace springtower {
namespace {

// Names that may be given where a command line could not be parsed: options of the command, and commands where there is none.
std::vector<std::string> namesOf(const CLI::App& command) {
  std::vector<std::string> names;
  for (const CLI::Option* option : command.get_options()) {
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  }
  for (const CLI::App* other : command.get_subcommands([](const CLI::App*) { return true; })) names.push_back(other->get_name());
  return names;
}

// The name that a word is nearest to, if it is near: a letter off, two in longer words, or an option that begins with it.
std::string nearestName(const std::string& word, const std::vector<std::string>& names) {
  constexpr std::size_t kLettersToAMistake = 5;
  constexpr std::size_t kShortestBegin = 4;
  std::string nearest;
  int least = 1 + static_cast<int>(word.size() / kLettersToAMistake);
  for (const std::string& name : names) {
    const bool begins = word.size() >= kShortestBegin && name.starts_with(word);
    const int apart = begins ? 1 : lettersApart(word, name);
    if (apart > least || (apart == least && !nearest.empty())) continue;
    least = apart;
    nearest = name;
  }
  return nearest;
}

// What CLI11 says of arguments that are missing, too many or do not go together, as what was expected and what was given.
std::string asExpected(const std::string& said) {
  constexpr std::pair<const char*, const char*> kForms[] = {
      {R"(^(\S+) is required$)", "expected $1, got none"},
      {R"(^(\S+) requires (\S+)$)", "$1: expected $2 as well, got none"},
      {R"(^(\S+) excludes (\S+)$)", "expected $1 or $2, got both"},
      {R"(^(\S+): \d+ required (.+) missing$)", "$1: expected $2, got none"},
      {R"(^(\S+): At Most (\d+) required but received (\d+)$)", "$1: expected at most $2, got $3"},
  };
  for (const auto& [form, ours] : kForms) {
    const std::regex pattern(form);
    if (std::regex_match(said, pattern)) return std::regex_replace(said, pattern, ours);
  }
  return said;
}

}  // namespace

int lettersApart(const std::string& one, const std::string& other) {
  const std::size_t columns = other.size() + 1;
  std::vector<int> beforeLast(columns);
  std::vector<int> last(columns);
  std::vector<int> now(columns);
  for (std::size_t j = 0; j < columns; ++j) now[j] = static_cast<int>(j);
  for (std::size_t i = 1; i <= one.size(); ++i) {
    beforeLast.swap(last);
    last.swap(now);
    now[0] = static_cast<int>(i);
    for (std::size_t j = 1; j < columns; ++j) {
      const int replaced = last[j - 1] + (one[i - 1] == other[j - 1] ? 0 : 1);
      now[j] = std::min({last[j] + 1, now[j - 1] + 1, replaced});
      const bool swapped = i > 1 && j > 1 && one[i - 1] == other[j - 2] && one[i - 2] == other[j - 1];
      if (swapped) now[j] = std::min(now[j], beforeLast[j - 2] + 1);
    }
  }
  return now.back();
}

std::string complaintAbout(const CLI::App& program, const CLI::ParseError& error) {
  const auto kind = static_cast<CLI::ExitCodes>(error.get_exit_code());
  // An argument that is mistyped leaves one that is required without its value: the cause comes first.
  const std::vector<std::string> unknown = kind == CLI::ExitCodes::ExtrasError || kind == CLI::ExitCodes::RequiredError
                                               ? program.remaining(true)
                                               : std::vector<std::string>{};
  if (unknown.empty()) return asExpected(onOneLine(error.what()));
  const CLI::App* command = &program;
  while (!command->get_subcommands().empty()) command = command->get_subcommands().front();
  const std::vector<std::string> names = namesOf(*command);
  std::string list;
  for (const std::string& word : unknown) {
    const std::string meant = nearestName(word.substr(0, word.find('=')), names);
    list += fmt::format("{}{}{}", list.empty() ? "" : ", ", inQuotes(word),
                        meant.empty() ? "" : fmt::format(" (did you mean {}?)", meant));
  }
  return fmt::format("expected arguments that --help lists, got the unknown argument{} {}", unknown.size() == 1 ? "" : "s", list);
}

}  // namespace springtower
