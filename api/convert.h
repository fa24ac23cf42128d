#pragma once

#include "core/error.h"
#include "core/scene/scene.h"

#include <springtower/scene.h>
#include <string>

// Between the plain structs of the public headers and those that the engine works on.

namespace springtower::api {

inline springtower::Vec3 toEngine(const Vec3& v) {
  return {v.x, v.y, v.z};
}
inline Vec3 toPublic(const springtower::Vec3& v) {
  return {v.x(), v.y(), v.z()};
}
inline Eigen::Quaterniond toEngine(const Quaternion& q) {
  return {q.w, q.x, q.y, q.z};
}
inline Quaternion toPublic(const Eigen::Quaterniond& q) {
  return {q.w(), q.x(), q.y(), q.z()};
}

/// Throw InputError for a value that is none of the enumeration's.
springtower::Method toEngine(Method method);
Method toPublic(springtower::Method method);
springtower::Sleep toEngine(Sleep sleep);

/// Numbers are copied as they are. Throws InputError for an enumeration's value that is none.
springtower::Settings toEngine(const Settings& settings);
Settings toPublic(const springtower::Settings& settings);

springtower::Gravity toEngine(const Gravity& gravity);
Gravity toPublic(const springtower::Gravity& gravity);
springtower::BlockSpec toEngine(const Block& block);
Block toPublic(const springtower::BlockSpec& block);
springtower::UserForce toEngine(const Force& force);
Force toPublic(const springtower::UserForce& force);
springtower::TowerOptions toEngine(const TowerOptions& options);

/// Numbers are copied as they are, for checkScene to look at. Throws InputError for an enumeration's value that is none.
springtower::Scene toEngine(const Scene& scene);
/// Precondition: the scene has no moves.
Scene toPublic(const springtower::Scene& scene);

/// What messages call a scene: its name on one line, or "scene".
std::string sourceOf(const Scene& scene);

/// Runs `body` and throws the engine's errors of input as those of the public headers.
template <class Body>
decltype(auto) withPublicErrors(const Body& body) {
  try {
    return body();
  } catch (const springtower::InputError& error) {
    throw InputError(error.what());
  }
}

}  // namespace springtower::api
