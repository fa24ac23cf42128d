#pragma once

#include "solver/hand/grip.h"

namespace springtower {

// Hands as bytes: the members of each type (core/byte_stream.h).

template <class Stream>
void fieldsOf(Stream& stream, Hand& hand) {
  auto& [block, place, turn, limit_n, velocity, rate_rad_s, line] = hand;
  stream(block, place, turn, limit_n, velocity, rate_rad_s, line);
}

template <class Stream>
void fieldsOf(Stream& stream, Grip& grip) {
  auto& [block, carried, turn, spin] = grip;
  stream(block, carried, turn, spin);
}

template <class Stream>
void fieldsOf(Stream& stream, Draw& draw) {
  auto& [hand, grip, speed_m_s, drawn_s] = draw;
  stream(hand, grip, speed_m_s, drawn_s);
}

}  // namespace springtower
