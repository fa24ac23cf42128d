#pragma once

#include "core/byte_stream.h"
#include "core/scene/scene.h"

#include <memory>
#include <optional>

namespace springtower {

// Scenes as bytes: the members of each type (core/byte_stream.h).

template <class Stream>
void fieldsOf(Stream& stream, Friction& friction) {
  auto& [staticFriction, kineticFriction] = friction;
  stream(staticFriction, kineticFriction);
}

template <class Stream>
void fieldsOf(Stream& stream, FrictionPair& pair) {
  auto& [a, b, friction] = pair;
  stream(a, b, friction);
}

template <class Stream>
void fieldsOf(Stream& stream, Drive& drive) {
  auto& [block, velocity, spin, amplitude, frequency_hz, start_s, end_s] = drive;
  stream(block, velocity, spin, amplitude, frequency_hz, start_s, end_s);
}

template <class Stream>
void fieldsOf(Stream& stream, UserForce& user) {
  auto& [block, corner, force, start_s, end_s, torque, point, forceAtEnd, torqueAtEnd] = user;
  stream(block, corner, force, start_s, end_s, torque, point, forceAtEnd, torqueAtEnd);
}

template <class Stream>
void fieldsOf(Stream& stream, Move& move) {
  auto& [kind, row, position, towards, speed_m_s, drop_m, limit_n, allowed_m] = move;
  stream(kind, row, position, towards, speed_m_s, drop_m, limit_n, allowed_m);
}

template <class Stream>
void fieldsOf(Stream& stream, Gravity& gravity) {
  auto& [magnitude, tilt_deg, direction_deg, sway_deg, sway_hz] = gravity;
  stream(magnitude, tilt_deg, direction_deg, sway_deg, sway_hz);
}

template <class Stream>
void fieldsOf(Stream& stream, BlockSpec& block) {
  auto& [centre, dimensions, orientation, velocity, spin, mass, row, position, restitution, fixed, friction, strain] = block;
  stream(centre, dimensions, orientation, velocity, spin, mass, row, position, restitution, fixed, friction);
  std::optional<CornerPlaces> places;
  if (strain != nullptr) places = *strain;
  stream(places);
  if constexpr (Stream::kReads) strain = places ? std::make_shared<const CornerPlaces>(*places) : nullptr;
}

template <class Stream>
void fieldsOf(Stream& stream, Settings& settings) {
  auto& [method, inertia, sleep, frame_s, tolerance_m, substeps, allowUnstable, stabilitySafety, springRatio, tangentialRatio,
         maxwellRatio, maxwellTime, stiffnessDamping, impactDepth, continuousTests, sleepSpeed, sleepTime, sleepImbalance,
         reportRestitution, reportFrictionDrag, reportDisableDistance_m, reportIterations, iterations] = settings;
  stream(method, inertia, sleep, frame_s, tolerance_m, substeps, allowUnstable, stabilitySafety, springRatio, tangentialRatio,
         maxwellRatio, maxwellTime, stiffnessDamping, impactDepth, continuousTests, sleepSpeed, sleepTime, sleepImbalance,
         reportRestitution, reportFrictionDrag, reportDisableDistance_m, reportIterations, iterations);
}

template <class Stream>
void fieldsOf(Stream& stream, Scene& scene) {
  auto& [name, blocks, forces, drives, moves, gravity, floor, plane, staticFriction, kineticFriction, restitution, floorFriction,
         frictionPairs, seconds, settings] = scene;
  stream(name, blocks, forces, drives, moves, gravity, floor, plane, staticFriction, kineticFriction, restitution, floorFriction,
         frictionPairs, seconds, settings);
}

}  // namespace springtower
