#include "tests/structure/reached_names.h"

#include <cctype>
#include <cstddef>
#include <set>
#include <string_view>
#include <utility>

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

// Whether a word at namespace level is a constant that is defined there: a type stands before it, and its value follows.
bool isConstant(std::string_view code, const Word& word, char next) {
  if (word.text[0] != 'k' || (next != '=' && next != '[' && next != '{') || word.begin == 0) return false;
  const std::size_t before = code.find_last_not_of(" \n", word.begin - 1);
  return before != std::string_view::npos && (isPartOfName(code[before]) || code[before] == '>');
}

// How deep a place lies in braces, those of namespaces left out.
class Braces {
 public:
  explicit Braces(std::string_view code) : code_(code) {}
  // Places in ascending order.
  int depthAt(std::size_t place) {
    for (; at_ < place; ++at_) {
      if (code_[at_] == '{') {
        isNamespace_.push_back(std::exchange(begins_, false));
        depth_ += isNamespace_.back() ? 0 : 1;
      } else if (code_[at_] == '}' && !isNamespace_.empty()) {
        depth_ -= isNamespace_.back() ? 0 : 1;
        isNamespace_.pop_back();
      }
    }
    return depth_;
  }
  // The next brace opens a namespace.
  void beginNamespace() { begins_ = true; }

 private:
  std::string_view code_;
  std::size_t at_ = 0;
  std::vector<bool> isNamespace_;
  bool begins_ = false;
  int depth_ = 0;
};

Header readHeader(std::string_view text) {
  Header header;
  const std::string code = codeOf(text, header.includes);
  const std::vector<Word> words = wordsOf(code);
  Braces braces(code);
  for (std::size_t i = 0; i < words.size(); ++i) {
    const int depth = braces.depthAt(words[i].begin);
    if (words[i].text == "namespace") {
      braces.beginNamespace();
      continue;
    }
    if (!isKnownKind(words[i].text)) continue;
    const std::string name(words[i].text);
    if (!isMember(code, words[i])) header.names.insert(name);
    if (i == 0) continue;
    const std::string_view before = words[i - 1].text;
    const std::size_t after = code.find_first_not_of(" \n", words[i].begin + name.size());
    const char next = after == std::string::npos ? ' ' : code[after];
    const bool isScope = next == ':' && code[after + 1] == ':';  // of a member that is defined
    const bool isType = !isScope && (before == "struct" || before == "class" || before == "using" || before == "union");
    if (isType && (depth > 0 || next == ';')) {
      header.declares.insert(name);
    } else if (isType && (next == '>' || next == ',')) {
      header.declares.insert(name);  // a parameter of a template
    } else if (depth > 0) {
      continue;
    } else if (isType || before == "enum" || isConstant(code, words[i], next)) {
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

std::vector<std::string> namesHidden(const std::map<std::string, std::string>& headers,
                                     const std::map<std::string, std::string>& sources) {
  std::map<std::string, std::string> owner;
  for (const auto& [path, text] : headers) {
    for (const std::string& name : readHeader(text).defines) owner.emplace(name, path);
  }
  std::vector<std::string> hidden;
  for (const auto& [path, text] : sources) {
    for (const std::string& name : readHeader(text).defines) {
      const auto found = owner.find(name);
      if (found != owner.end()) hidden.push_back(path + ": " + name + " is that of " + found->second + " as well");
    }
  }
  return hidden;
}

}  // namespace springtower
