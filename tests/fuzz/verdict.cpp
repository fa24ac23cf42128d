// Lists of towers, as `springtower verdict` reads them.
#include "apps/commands/verdict/verdict.h"

#include "core/error.h"
#include "tests/fuzz/fuzz.h"

#include <sstream>

namespace springtower {
namespace {

void readAndStep(std::string_view text) {
  std::istringstream input{std::string(text)};
  std::vector<VerdictLine> lines;
  try {
    lines = readVerdictLines(input, "list.jsonl");
  } catch (const InputError& error) {
    requireMessage(error.what(), "list.jsonl: line ");
    return;
  }
  for (const VerdictLine& line : lines) {
    if (isClear(line)) requireThat(line.expect.at("stands").is_boolean(), "a clear line says yes or no");
    checkScene(line.scene, "a scene that was read");
  }
  if (!lines.empty()) stepFrames(lines.front().scene, 2);
}

}  // namespace
}  // namespace springtower

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  springtower::readAndStep(springtower::textOf(data, size));
  return 0;
}
