#include "solver/reference/report_response.h"

#include "core/tuning.h"
#include "solver/block/inertia.h"
#include "solver/world/driven_blocks.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace springtower {

namespace {

// Inverse mass of a weighted point: (own sum of w^2 - shared) / m; with equal corner masses the sum of w_i^2 / m_i.
double inverseMassOf(const IslandStep& step, const ReportSide& side) {
  if (!moves(step, side)) return 0.0;
  const InverseMass inverse = inverseMass(step.simulation.scene.settings.inertia);
  double squares = 0.0;
  for (const double w : side.weight) squares += w * w;
  return (inverse.own * squares - inverse.shared) / step.simulation.model.mass[static_cast<std::size_t>(side.block)];
}

// Distributes an impulse (N s) over a block's corners and updates its path: the report changes the next position at once (its
// 4.5).
void push(IslandStep& step, const ReportSide& side, const Vec3& impulse) {
  if (!moves(step, side)) return;
  const auto b = static_cast<std::size_t>(side.block);
  const InverseMass inverse = inverseMass(step.simulation.scene.settings.inertia);
  const Vec3 kick = impulse / step.simulation.model.mass[b];
  std::array<double, kCorners> factor;
  factor.fill(-inverse.shared);
  for (std::size_t i = 0; i < side.corner.size(); ++i)
    factor[static_cast<std::size_t>(side.corner[i])] += inverse.own * side.weight[i];
  for (std::size_t c = 0; c < kCorners; ++c) {
    if (factor[c] != 0.0) step.simulation.state.velocity.add(b, c, factor[c] * kick);
  }
  layPath(step, b);
}

void note(IslandStep& step, const ReportContact& contact) {
  const Simulation& simulation = step.simulation;
  ReportState& report = step.engine.report;
  const auto sleeps = [&](std::int32_t b) { return b >= 0 && simulation.asleep[static_cast<std::size_t>(b)] != 0; };
  const bool firstSleeps = sleeps(contact.first);
  const auto owner = static_cast<std::size_t>(firstSleeps ? contact.second : contact.first);
  std::vector<ReportContact>& list = report.contacts[owner];
  const auto same = std::find_if(list.begin(), list.end(), [&](const ReportContact& other) {
    return other.first == contact.first && other.second == contact.second && other.firstCount == contact.firstCount &&
           other.corner == contact.corner;
  });
  if (same == list.end()) {
    list.push_back(contact);
  } else {
    same->impulse += contact.impulse;
  }
  const std::int32_t sleeper = firstSleeps ? contact.first : contact.second;
  if (!isSleeper(simulation, sleeper)) return;
  const double particle = simulation.model.mass[static_cast<std::size_t>(sleeper)] / static_cast<double>(kCorners);
  const double speed =
      tuning::kReportEnablingSpeed * std::sqrt(simulation.scene.gravity.magnitude * simulation.lengths.blockHeight_m);
  if (contact.impulse > speed * particle) report.struck[owner].push_back(sleeper);
}

}  // namespace

ReportSide firstSide(const ReportContact& c) {
  const auto count = static_cast<std::size_t>(c.firstCount);
  return {c.first, std::span(c.corner).first(count), std::span(c.weight).first(count)};
}

ReportSide secondSide(const ReportContact& c) {
  const auto from = static_cast<std::size_t>(c.firstCount);
  const auto count = static_cast<std::size_t>(c.secondCount);
  return {c.second, std::span(c.corner).subspan(from, count), std::span(c.weight).subspan(from, count)};
}

bool moves(const IslandStep& step, const ReportSide& side) {
  return side.block >= 0 && step.simulation.asleep[static_cast<std::size_t>(side.block)] == 0;
}

Vec3 velocityOf(const IslandStep& step, const ReportSide& side) {
  Vec3 sum = Vec3::Zero();
  if (!moves(step, side) && !isDriven(step, side.block)) return sum;
  for (std::size_t i = 0; i < side.corner.size(); ++i) {
    sum += side.weight[i] *
           step.simulation.state.velocity.at(static_cast<std::size_t>(side.block), static_cast<std::size_t>(side.corner[i]));
  }
  return sum;
}

void layPath(IslandStep& step, std::size_t b) {
  const MotionState& state = step.simulation.state;
  ReportState& report = step.engine.report;
  for (std::size_t a = 0; a < 3; ++a) {
    const double* x = state.position.values(a, b);
    const double* v = state.velocity.values(a, b);
    double* from = report.from.values(a, b);
    double* to = report.to.values(a, b);
    double* low = report.low.values(a, b);
    double* high = report.high.values(a, b);
    for (std::size_t c = 0; c < kCorners; ++c) {
      const double move = step.drift_s * v[c];
      from[c] = x[c] - tuning::kReportTimeThreshold * move;
      to[c] = x[c] + (1.0 + tuning::kReportTimeThreshold) * move;
      low[c] = std::min(from[c], to[c]);
      high[c] = std::max(from[c], to[c]);
    }
  }
  ++report.version[b];
}

bool respond(IslandStep& step, ReportContact& contact) {
  const ReportSide first = firstSide(contact);
  const ReportSide second = secondSide(contact);
  const double approach = contact.normal.dot(velocityOf(step, first) - velocityOf(step, second));
  if (!(approach < 0.0)) return false;
  contact.impulse = -(1.0 + step.simulation.scene.settings.reportRestitution) * approach /
                    (inverseMassOf(step, first) + inverseMassOf(step, second));
  push(step, first, contact.impulse * contact.normal);
  push(step, second, -contact.impulse * contact.normal);
  note(step, contact);
  return true;
}

}  // namespace springtower
