#pragma once

namespace springtower {

// Sizes by which contacts are judged, in heights of the scene's lowest block, so that any size of block works unchanged.

/// A manifold is renewed when its blocks have moved this far together. Between renewals its points are fixed on the upper block's
/// face and slide over the lower one's, which is exact for the depth; only the outline of the overlap is late by this much.
inline constexpr double kRefreshTravel = 0.02;
/// The same for blocks that slide in implicit steps, of which a frame has few: an outline that is renewed in every other step
/// makes the load jump to and fro.
inline constexpr double kSlidingRefreshTravel = 0.002;
/// The same for blocks that touch at one or two points and may roll, in explicit steps: at each renewal they sink by what the
/// outline was late.
inline constexpr double kRollingRefreshTravel = 0.004;
/// Points higher above the reference face than this are left out; three renewals away, so none can be missed.
inline constexpr double kManifoldReach = 0.06;
/// Points of a manifold nearer to each other are one: flush corners would else be held twice and take turns.
inline constexpr double kMergeRadius = 0.01;
/// A new manifold's point takes over the memory of an old one within this; it is above what an outline can move between renewals.
inline constexpr double kCarryRadius = 0.05;
/// How much better the other block's face must separate before it becomes the reference; also what a crossing of edges must win
/// by.
inline constexpr double kReferenceSlack = 0.005;
/// Faces that are tilted a little against each other are a face contact as long as their common outline is not deeper by more
/// than this than the edges that separate them better.
inline constexpr double kEdgeSlack = 0.01;
/// A pair is let go when it is farther apart than this and no point touches.
inline constexpr double kPartingGap = 1e-3;
/// A contact whose blocks overlapped by more than this before its step was born penetrating.
inline constexpr double kBornError = 1e-6;
/// Swept boxes are grown by this, for what contacts may add to the motion foreseen.
inline constexpr double kSweepMargin = 0.1;
/// A block whose corners move apart by more than this share of its least side in one step has diverged.
inline constexpr double kMaxTravelPerStep = 0.5;

/// The scene's own scale, and the sizes above in metres.
struct Lengths {
  double blockHeight_m = 0.0;  ///< h, least side of any block
  double fallTime_s = 0.0;     ///< sqrt(h / g), in which times are measured; without gravity with that of Earth
  double contactError_m = 0.0;
  double partingGap_m = 0.0;
};

}  // namespace springtower
