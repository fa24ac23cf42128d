#include "solver/frame/island_modes.h"

#include <gtest/gtest.h>

namespace springtower {
namespace {

IslandFacts movingIsland() {
  IslandFacts facts;
  facts.leftAlone = true;
  facts.rigidBefore = true;
  facts.staysRigid = true;
  return facts;
}

// Also those that a hand holds by one of their blocks.
TEST(IslandModes, FastIslandsTakeRigidSteps) {
  IslandFacts facts;
  facts.leftAlone = true;
  EXPECT_EQ(nextMode(ModeChange::frameBegins, facts), IslandMode::implicit);
  facts.fast = true;
  EXPECT_EQ(nextMode(ModeChange::frameBegins, facts), IslandMode::rigid);
  facts.leftAlone = false;
  EXPECT_EQ(nextMode(ModeChange::frameBegins, facts), IslandMode::rigid);
}

// What has moved or hit something goes on in rigid steps until it has been slow for a time.
TEST(IslandModes, WhatMovesStaysInRigidSteps) {
  EXPECT_EQ(nextMode(ModeChange::frameBegins, movingIsland()), IslandMode::rigid);
  IslandFacts slow = movingIsland();
  slow.staysRigid = false;
  EXPECT_EQ(nextMode(ModeChange::frameBegins, slow), IslandMode::implicit);
  IslandFacts held = movingIsland();
  held.leftAlone = false;
  EXPECT_EQ(nextMode(ModeChange::frameBegins, held), IslandMode::implicit) << "a hand takes hold";
}

// Between the parts of a frame its speed decides nothing.
TEST(IslandModes, AFrameInPartsGoesOnAsItBegan) {
  IslandFacts facts;
  EXPECT_EQ(nextMode(ModeChange::frameContinues, facts), IslandMode::implicit);
  facts.rigidBefore = true;
  EXPECT_EQ(nextMode(ModeChange::frameContinues, facts), IslandMode::rigid);
}

}  // namespace
}  // namespace springtower
