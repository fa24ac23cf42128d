#include "solver/runner/run_state.h"

#include "core/byte_stream.h"
#include "core/scene/scene.h"
#include "solver/world/simulation.h"
#include "tests/support/block_scenes.h"
#include "tests/support/prepare_and_step.h"

#include <cstdint>
#include <cstring>
#include <gtest/gtest.h>
#include <sstream>

namespace springtower {
namespace {

// Bytes of another layout are read as something else: an index of them may be any number. Whoever adds, removes or widens what is
// saved gives the files another format, by which they are refused (kFormat in core/byte_stream.cpp), and writes both numbers
// here.
TEST(SavedRun, OfAnotherLayoutHasAnotherFormat) {
  Scene scene = bitCodeScene("(010)-(010)");
  scene.forces.push_back(constantForce(1, 3, Vec3(0.0, 0.0, -0.1), 0.0, 1.0));
  Simulation simulation(scene);
  prepareAndStep(simulation);
  std::ostringstream stream;
  writeRun({scene, takeSnapshot(simulation), {}}, stream);
  const std::string bytes = stream.str();

  constexpr std::size_t kLetters = 16;  // of the kind of file; the format comes next
  std::uint32_t format = 0;
  std::memcpy(&format, bytes.data() + kLetters, sizeof format);
  EXPECT_EQ(format, 4U);
  EXPECT_EQ(unsealed(SealKind::run, bytes, "run").payload.size(), 11662U);
}

}  // namespace
}  // namespace springtower
