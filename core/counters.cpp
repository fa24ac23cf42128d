#include "core/counters.h"

namespace springtower {

Counters& Counters::operator+=(const Counters& other) {
  frames += other.frames;
  steps += other.steps;
  replayedFrames += other.replayedFrames;
  blockPairs += other.blockPairs;
  clearanceChecks += other.clearanceChecks;
  candidateTests += other.candidateTests;
  boxOverlaps += other.boxOverlaps;
  planeCrossings += other.planeCrossings;
  cubicTests += other.cubicTests;
  cubicHits += other.cubicHits;
  contactsCreated += other.contactsCreated;
  contactsCreatedPenetrating += other.contactsCreatedPenetrating;
  manifoldRefreshes += other.manifoldRefreshes;
  contactEvaluations += other.contactEvaluations;
  springEvaluations += other.springEvaluations;
  implicitSteps += other.implicitSteps;
  implicitIterations += other.implicitIterations;
  factorisations += other.factorisations;
  newtonFailures += other.newtonFailures;
  responseIterations += other.responseIterations;
  return *this;
}

}  // namespace springtower
