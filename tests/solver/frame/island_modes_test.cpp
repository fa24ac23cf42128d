#include "solver/frame/island_modes.h"

#include <gtest/gtest.h>

namespace springtower {
namespace {

IslandFacts fastIsland() {
  IslandFacts facts;
  facts.blocks = 54;
  facts.leftAlone = true;
  facts.fast = true;
  facts.moving = true;
  return facts;
}

TEST(IslandModes, FastIslandsThatAreLeftAloneTakeRigidSteps) {
  EXPECT_EQ(nextMode(ModeChange::frameBegins, fastIsland()), IslandMode::rigid);
  IslandFacts slow = fastIsland();
  slow.fast = false;
  EXPECT_EQ(nextMode(ModeChange::frameBegins, slow), IslandMode::implicit);
  IslandFacts held = fastIsland();
  held.leftAlone = false;
  EXPECT_EQ(nextMode(ModeChange::frameBegins, held), IslandMode::implicit);
}

TEST(IslandModes, OneOrTwoBlocksReboundSoTheyStayImplicit) {
  for (const std::size_t blocks : {1U, 2U, 3U, 255U, 256U, 10000U}) {
    IslandFacts facts = fastIsland();
    facts.blocks = blocks;
    const bool rigid = blocks >= 3;
    EXPECT_EQ(nextMode(ModeChange::frameBegins, facts), rigid ? IslandMode::rigid : IslandMode::implicit) << blocks;
  }
}

// Below the entry speed, rigid mode continues until the exit speed is reached.
TEST(IslandModes, AFallGoesOnUntilItIsSlow) {
  IslandFacts falling = fastIsland();
  falling.rigidBefore = true;
  falling.fast = false;
  EXPECT_EQ(nextMode(ModeChange::frameBegins, falling), IslandMode::rigid);
  falling.moving = false;
  EXPECT_EQ(nextMode(ModeChange::frameBegins, falling), IslandMode::implicit);
  falling.rigidPinned = true;
  EXPECT_EQ(nextMode(ModeChange::frameBegins, falling), IslandMode::rigid) << "implicit steps have just failed";
  falling.leftAlone = false;
  EXPECT_EQ(nextMode(ModeChange::frameBegins, falling), IslandMode::implicit) << "a hand takes hold";
}

TEST(IslandModes, FailedImplicitStepsAreFollowedByRigidOnesWhereBlocksHaveFallen) {
  IslandFacts facts = fastIsland();
  EXPECT_EQ(nextMode(ModeChange::implicitFailed, facts), IslandMode::explicitFallback);
  facts.mostlyFallen = true;
  EXPECT_EQ(nextMode(ModeChange::implicitFailed, facts), IslandMode::rigid);
  facts.leftAlone = false;
  EXPECT_EQ(nextMode(ModeChange::implicitFailed, facts), IslandMode::explicitFallback);
}

// Explicit steps of hundreds of blocks would take seconds a frame.
TEST(IslandModes, FailedImplicitStepsOfLargeIslandsAreFollowedByRigidOnes) {
  IslandFacts facts = fastIsland();
  facts.blocks = 432;
  EXPECT_EQ(nextMode(ModeChange::implicitFailed, facts), IslandMode::rigid);
}

// Between the parts of a frame its speed decides nothing.
TEST(IslandModes, AFrameInPartsGoesOnAsItBegan) {
  IslandFacts facts = fastIsland();
  EXPECT_EQ(nextMode(ModeChange::frameContinues, facts), IslandMode::implicit);
  facts.rigidBefore = true;
  facts.moving = facts.fast = false;
  EXPECT_EQ(nextMode(ModeChange::frameContinues, facts), IslandMode::rigid);
}

}  // namespace
}  // namespace springtower
