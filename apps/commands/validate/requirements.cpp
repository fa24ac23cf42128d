#include "apps/commands/validate/validate.h"

namespace springtower {

// Tests are named SUITE.NAME in backticks; a test checks that each of them is there.
const std::vector<Requirement>& reportRequirements() {
  static const std::vector<Requirement> requirements = {
      {"1.1", "A player should be able to remove a block from the tower.",
       "`ViewerWindow.APlayerDrawsTheLooseBlockAndLaysItOnTop` (mouse and wheel in a real window), "
       "`ViewerGame.DrawingPlacingAndUndoing`; Sleep above (a block pulled out at 4 cm/s)"},
      {"1.2", "A player should be able to place a block back on top of the tower.",
       "Moves above; `ViewerWindow.APlayerDrawsTheLooseBlockAndLaysItOnTop`, `ViewerGame.DrawingPlacingAndUndoing`"},
      {"1.3", "Input should be analogue to simulate a player's movement in the real game.",
       "`ViewerControls.WithTheFreeKeyItDragsInThePlaneOfTheScreenAndAlongTheView`, "
       "`ViewerControls.APressSelectsAndADragPullsAlongTheBlock`, `NaivePlayer.SucceedsInNineOfTenGamesOfFixedSeeds`, "
       "`Grip.ABlockInTheAirFollowsCriticallyDamped`, `Grip.FrictionAnswersTheHand`: a force of at most 5 N that follows the "
       "mouse"},
      {"1.4", "The camera should allow for full view of all sides of the tower.",
       "`ViewerCamera.GoesAllTheWayRoundAndOverTheTop`, `ViewerCamera.ShowsTheWholeTower`, "
       "`ViewerControls.ADragBesideTheBlocksGoesRound`"},
      {"2.1", "Gravity should be modelled.",
       "`MethodTest.FreeFallFollowsTheClosedForm`, `RunScene.FreeFallIsAFallAndLosesNoEnergy`"},
      {"2.2", "Friction should be modelled.",
       "Pulling above; `SlopeTest.StaysJustBelowTheFrictionAngle`, `SlopeTest.SlidesJustAboveTheFrictionAngle`"},
      {"2.3", "The tower should stay up when in a stable state.",
       "Verdicts above; `FullTower.StandsStillWithoutSleep`, `UnevenTowerTest.StandsStillWithoutSleep`"},
      {"2.4", "The tower should collapse when in an unstable state.",
       "Verdicts and Turning gravity above; `PublishedTest.DoesWhatTheRealTowerDid`, `CollapseTest.IsWithoutFlaw`"},
      {"2.5", "The tower should behave as 'expected' when a block is removed from it.",
       "Verdicts above (removal); `Statics.RemovalsBringDownWhatTheyCarry`"},
      {"2.6", "The tower should behave as 'expected' when a block is placed on top of it.",
       "Moves above; `PlacedTest.ABlockLaidOnTopStaysOrTipsWhatIsBelow`, `ViewerWindow.APlayerDrawsTheLooseBlockAndLaysItOnTop` "
       "(no other "
       "block moves by 5 mm)"},
      {"2.7", "Blocks should not be able to pass through other blocks.",
       "`ThinWall.IsHitWithCubicTests`, `QuerySet.NoneMissedNoneLateNoneFalse`"},
      {"2.8", "Blocks should not be able to become embedded with other blocks.",
       "`CollapseTest.IsWithoutFlaw`, `TwoBlocks.ThrownAtEachOtherKeepTheirBounds`"},
      {"2.9", "The blocks should not jitter.", "`FullTower.StandsStillWithoutSleep`, `ReportFailure.ATowerJittersAndCreeps`"},
      {"3.1", "The program should not crash or freeze.",
       "`BadSceneFile.IsNamedInOneLine`, `RunCommand.DivergenceHasItsOwnExitCodeAndKeepsThePoses`; every test again under "
       "sanitizers"},
      {"3.2", "The game should run in real-time, no less than 12 frames per second.",
       "`springtower profile`; `Sleep.TheFullTowerSleepsWithinFiveSecondsAndThenCostsNothing`"},
      {"3.3", "The program should be simple and intuitive to use.",
       "`Program.HelpTeachesWithExamples`, `RefusesTest.InOneLineWithExitCodeTwo`"},
  };
  return requirements;
}

}  // namespace springtower
