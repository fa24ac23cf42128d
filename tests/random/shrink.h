#pragma once

#include "scenarios/random_scene.h"
#include "tests/random/record.h"

#include <functional>

namespace springtower {

/// Judges a scene that may be smaller. Whatever it does, it comes back.
using JudgeFunction = std::function<Record(const RandomScene&)>;

/// What shrinking made of a scene.
struct Shrunk {
  RandomScene random;
  Record record;   ///< of that scene
  int judged = 0;  ///< how many scenes were judged on the way
};

/// Makes a scene with a fault smaller while it keeps this fault: fewer blocks, moves and forces, nothing that moves at the start,
/// settings as they are by default, numbers of few digits, a shorter time. Judges at most `mostJudged` scenes. What the scene
/// check refuses is not judged. Precondition: `record` is that of the scene, and has the fault.
Shrunk shrinkScene(const RandomScene& random, const Record& record, Fault fault, const JudgeFunction& judge, int mostJudged);

}  // namespace springtower
