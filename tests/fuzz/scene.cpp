// Scene files: what is no scene is refused with a message, and what is one can be stepped.
#include "core/error.h"
#include "tests/fuzz/fuzz.h"

namespace springtower {
namespace {

void readAndStep(std::string_view text) {
  const InputFile file(text);
  Scene scene;
  try {
    scene = sceneFromToml(file.path());
  } catch (const InputError& error) {
    requireMessage(error.what(), file.path());
    return;
  }
  checkScene(scene, "a scene that was read");
  stepFrames(scene, 3);
}

}  // namespace
}  // namespace springtower

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  springtower::readAndStep(springtower::textOf(data, size));
  return 0;
}
