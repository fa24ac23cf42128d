// Scenes by name: bit codes and NAME:SIZE with any options. Files are left to the target `scene`.
#include "core/error.h"
#include "scenarios/registry.h"
#include "tests/fuzz/fuzz.h"

namespace springtower {
namespace {

// Some options inside and outside their ranges, of the first 20 bytes.
TowerOptions optionsOf(Bytes& bytes) {
  TowerOptions options;
  const int given = bytes.below(64);
  if ((given & 1) != 0) options.heightsSigma_m = bytes.between(-1e-4, 0.0032);
  if ((given & 2) != 0) options.massSigma_kg = bytes.between(-1e-4, 0.006);
  if ((given & 4) != 0) options.seed = bytes.next<std::uint64_t>();
  if ((given & 8) != 0) options.startGap_m = bytes.between(-0.01, 1.01);
  if ((given & 16) != 0)
    options.offsets.push_back({bytes.below(256) - 1, bytes.below(6) - 1, bytes.between(-0.1, 0.1), bytes.between(-0.1, 0.1)});
  if ((given & 32) != 0) options.loose.push_back({bytes.below(256) - 1, bytes.below(6) - 1, bytes.between(-0.001, 0.01)});
  return options;
}

void makeAndStep(const TowerOptions& options, const std::string& name) {
  Scene scene;
  try {
    // A name that is no scenario's is that of a file, whatever there is of this name.
    const bool isCode = name.starts_with('(');
    if (isCode) {
      scene = bitCodeScene(name, options);
    } else if (findScenario(name.substr(0, name.find(':'))) != nullptr) {
      scene = sceneNamed(name, options);
    } else {
      return;
    }
  } catch (const InputError& error) {
    requireMessage(error.what());
    return;
  }
  checkScene(scene, "a scene that was made");
  stepFrames(scene, 2);
}

}  // namespace
}  // namespace springtower

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  constexpr std::size_t kOptions = 20;
  springtower::Bytes bytes(data, std::min(size, kOptions));
  const springtower::TowerOptions options = springtower::optionsOf(bytes);
  if (size > kOptions) springtower::makeAndStep(options, std::string(springtower::textOf(data + kOptions, size - kOptions)));
  return 0;
}
