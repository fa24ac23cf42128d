#include "tests/structure/reached_names.h"

#include <cctype>
#include <cstddef>
#include <set>
#include <string_view>

namespace springtower {
namespace {

bool isPartOfName(char c) {
  return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_';
}

bool isUpper(char c) {
  return std::isupper(static_cast<unsigned char>(c)) != 0;
}

// Whether a word may be a type or a constant of the project.
bool isKnownKind(std::string_view word) {
  return word.size() > 1 && (isUpper(word[0]) || (word[0] == 'k' && isUpper(word[1])));
}

// The code of a header: no comments, strings or directives. What it includes of the project goes into `includes`.
std::string codeOf(std::string_view text, std::set<std::string>& includes) {
  std::string code;
  while (!text.empty()) {
    const std::size_t end = text.find('\n');
    std::string_view line = text.substr(0, end);
    text = end == std::string_view::npos ? std::string_view{} : text.substr(end + 1);
    line = line.substr(0, line.find("//"));
    if (line.starts_with('#')) {
      const std::size_t open = line.find('"');
      if (open != std::string_view::npos) includes.emplace(line.substr(open + 1, line.rfind('"') - open - 1));
      continue;
    }
    bool quoted = false;
    for (const char c : line) {
      if (c == '"') quoted = !quoted;
      code += quoted || c == '"' ? ' ' : c;
    }
    code += '\n';
  }
  return code;
}

struct Word {
  std::string_view text;
  std::size_t begin = 0;
};

std::vector<Word> wordsOf(std::string_view code) {
  std::vector<Word> words;
  for (std::size_t i = 0; i < code.size();) {
    if (!isPartOfName(code[i])) {
      ++i;
      continue;
    }
    std::size_t end = i;
    while (end < code.size() && isPartOfName(code[end])) ++end;
    words.push_back({code.substr(i, end - i), i});
    i = end;
  }
  return words;
}

struct Header {
  std::set<std::string> includes;
  std::set<std::string> defines;   // at namespace level
  std::set<std::string> declares;  // "struct Name;", types of its types, parameters of templates
  std::set<std::string> names;     // all that it uses, its own included
};

// Where a word stands after "::", "." or "->" it is a member, and its owner is what has to be reached.
bool isMember(std::string_view code, const Word& word) {
  if (word.begin == 0) return false;
  const char before = code[word.begin - 1];
  return before == '.' || before == ':' || (before == '>' && word.begin > 1 && code[word.begin - 2] == '-');
}

Header readHeader(std::string_view text) {
  Header header;
  const std::string code = codeOf(text, header.includes);
  const std::vector<Word> words = wordsOf(code);
  int depth = 0;       // of braces, those of namespaces left out
  std::size_t at = 0;  // how far braces are counted
  for (std::size_t i = 0; i < words.size(); ++i) {
    for (; at < words[i].begin; ++at) {
      if (code[at] == '{') ++depth;
      if (code[at] == '}') --depth;
    }
    if (words[i].text == "namespace") {
      const std::size_t open = code.find('{', words[i].begin);
      if (open != std::string::npos) at = open + 1;
      continue;
    }
    if (!isKnownKind(words[i].text)) continue;
    const std::string name(words[i].text);
    if (!isMember(code, words[i])) header.names.insert(name);
    if (i == 0) continue;
    const std::string_view before = words[i - 1].text;
    const std::size_t after = code.find_first_not_of(" \n", words[i].begin + name.size());
    const char next = after == std::string::npos ? ' ' : code[after];
    const bool isType = before == "struct" || before == "class" || before == "using" || before == "union";
    if (isType && (depth > 0 || next == ';')) {
      header.declares.insert(name);
    } else if (isType && (next == '>' || next == ',')) {
      header.declares.insert(name);  // a parameter of a template
    } else if (depth > 0) {
      continue;
    } else if (isType || before == "enum" || (name[0] == 'k' && (next == '=' || next == '[' || next == '{'))) {
      header.defines.insert(name);
    }
  }
  return header;
}

void reach(const std::map<std::string, Header>& headers, const std::string& path, std::set<std::string>& reached) {
  const auto found = headers.find(path);
  if (found == headers.end() || !reached.insert(path).second) return;
  for (const std::string& next : found->second.includes) reach(headers, next, reached);
}

}  // namespace

std::vector<std::string> namesNotReached(const std::map<std::string, std::string>& headers) {
  std::map<std::string, Header> read;
  std::set<std::string> defined;
  for (const auto& [path, text] : headers) {
    Header header = readHeader(text);
    defined.insert(header.defines.begin(), header.defines.end());
    read.emplace(path, std::move(header));
  }
  std::vector<std::string> missing;
  for (const auto& [path, header] : read) {
    std::set<std::string> reached;
    reach(read, path, reached);
    std::set<std::string> known;
    for (const std::string& other : reached) {
      known.insert(read.at(other).defines.begin(), read.at(other).defines.end());
      known.insert(read.at(other).declares.begin(), read.at(other).declares.end());
    }
    for (const std::string& name : header.names) {
      if (defined.contains(name) && !known.contains(name)) missing.push_back(path + ": " + name + " is not reached");
    }
  }
  return missing;
}

}  // namespace springtower
