#include "core/counters.h"

namespace springtower {

Counters& Counters::operator+=(const Counters& other) {
  frames += other.frames;
  steps += other.steps;
  replayedFrames += other.replayedFrames;
  blockPairs += other.blockPairs;
  marginsSpent += other.marginsSpent;
  candidateTests += other.candidateTests;
  boxOverlaps += other.boxOverlaps;
  planeCrossings += other.planeCrossings;
  cubicTests += other.cubicTests;
  cubicHits += other.cubicHits;
  contactsBorn += other.contactsBorn;
  contactsBornPenetrating += other.contactsBornPenetrating;
  manifoldRefreshes += other.manifoldRefreshes;
  contactEvaluations += other.contactEvaluations;
  springEvaluations += other.springEvaluations;
  implicitSteps += other.implicitSteps;
  implicitIterations += other.implicitIterations;
  factorisations += other.factorisations;
  handedOver += other.handedOver;
  responseIterations += other.responseIterations;
  return *this;
}

}  // namespace springtower
