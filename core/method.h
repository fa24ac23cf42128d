#pragma once

#include <cstdint>

namespace springtower {

/// How a frame is stepped. `automatic` is replaced by the one that suits the scene when its simulation is set up.
enum class Method {
  implicit,
  implicitEuler,
  implicitEigen,
  semiImplicitEuler,
  midpoint,
  rungeKutta4,
  report,
  rigidPgs,
  rigidLcp,
  xpbd,
  automatic
};

/// What a method solves for: the state at a step's end (implicit); forces at its beginning (explicitSprings); impulses or
/// positions of rigid blocks (rigid); or impulses by the rules of the 2003 report on explicit springs (report).
enum class MethodFamily : std::uint8_t { implicit, explicitSprings, rigid, report };

/// Properties of a method that the engine uses; all that is alike in a family is decided by the family.
struct MethodTraits {
  MethodFamily family = MethodFamily::implicit;
  bool twoStep = false;     ///< implicit: BDF2, which uses the step before, instead of backward Euler
  bool leapfrog = false;    ///< its steps keep velocities half a step behind
  bool multiStage = false;  ///< explicit: several evaluations of the forces a step
  bool anchors = false;     ///< rigid: contacts are constraints of positions instead of impulses
};

/// One row a method. Precondition: not `automatic`, which is another one once a simulation is set up.
constexpr MethodTraits traitsOf(Method method) {
  switch (method) {
    case Method::implicit:
    case Method::implicitEigen:
      return {.family = MethodFamily::implicit, .twoStep = true};
    case Method::implicitEuler:
      return {.family = MethodFamily::implicit};
    case Method::semiImplicitEuler:
      return {.family = MethodFamily::explicitSprings, .leapfrog = true};
    case Method::midpoint:
    case Method::rungeKutta4:
      return {.family = MethodFamily::explicitSprings, .multiStage = true};
    case Method::report:
      return {.family = MethodFamily::report};
    case Method::rigidPgs:
    case Method::rigidLcp:
      return {.family = MethodFamily::rigid};
    case Method::xpbd:
      return {.family = MethodFamily::rigid, .anchors = true};
    case Method::automatic:
      break;
  }
  return {.family = MethodFamily::explicitSprings};
}

/// Whether a method solves for the state at its step's end.
constexpr bool isImplicit(Method method) {
  return traitsOf(method).family == MethodFamily::implicit;
}

/// Whether a method takes blocks as rigid: it has no stiffness, and its parameters are substeps and iterations.
constexpr bool isRigid(Method method) {
  return traitsOf(method).family == MethodFamily::rigid;
}

/// Whether a step of any length is stable.
constexpr bool isStableForAnyStep(Method method) {
  return isImplicit(method) || isRigid(method);
}

}  // namespace springtower
