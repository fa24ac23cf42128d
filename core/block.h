#pragma once

#include "core/vector.h"

#include <array>
#include <cstddef>

namespace springtower {

// A block is 8 particles, its corners, and 28 springs, one between any two corners (report 4.1). Corners are numbered by their
// bits: x = 1, y = 2, z = 4; a set bit is the positive side. The springs fall into seven groups by the exclusive or of their
// corners' numbers; inside a group no two springs share a corner and all four have one rest length: x, y, xy, z, xz, yz, xyz for
// groups 1 to 7.

inline constexpr std::size_t kCorners = 8;
inline constexpr std::size_t kSprings = 28;
inline constexpr std::size_t kSpringGroups = 7;
inline constexpr std::size_t kEdges = 12;
inline constexpr std::size_t kFaces = 6;
inline constexpr std::size_t kTriangles = 12;

/// The two corners of each edge; edges 0..3 run along x, 4..7 along y, 8..11 along z, the first corner on the negative side.
inline constexpr std::array<std::array<int, 2>, kEdges> kEdgeCorners = {
    {{0, 1}, {2, 3}, {4, 5}, {6, 7}, {0, 2}, {1, 3}, {4, 6}, {5, 7}, {0, 4}, {1, 5}, {2, 6}, {3, 7}}};

/// The four corners of each face, counterclockwise seen from outside; faces -x, +x, -y, +y, -z, +z, so face 2 a + s is the face
/// on side s (0 negative, 1 positive) of axis a.
inline constexpr std::array<std::array<int, 4>, kFaces> kFaceCorners = {
    {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}}};

/// The two triangles of each face (report Figure 4.6), counterclockwise seen from outside: triangle 2 f and 2 f + 1 belong to
/// face f.
inline constexpr std::array<std::array<int, 3>, kTriangles> kTriangleCorners = {{{0, 4, 6},
                                                                                 {0, 6, 2},
                                                                                 {1, 3, 7},
                                                                                 {1, 7, 5},
                                                                                 {0, 1, 5},
                                                                                 {0, 5, 4},
                                                                                 {2, 6, 7},
                                                                                 {2, 7, 3},
                                                                                 {0, 2, 3},
                                                                                 {0, 3, 1},
                                                                                 {4, 5, 7},
                                                                                 {4, 7, 6}}};

/// The side of a corner along axis a (0 x, 1 y, 2 z): -1 or +1.
constexpr double cornerSide(std::size_t corner, std::size_t axis) {
  return ((corner >> axis) & 1U) != 0U ? 1.0 : -1.0;
}

}  // namespace springtower
