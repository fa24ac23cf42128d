#include "core/tuning.h"
#include "solver/contact/rigid_contacts.h"
#include "solver/rigid/methods.h"
#include "solver/rigid/rebound.h"
#include "solver/rigid/run.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace springtower {

namespace {

// A linear complementarity problem with bounds: velocity = matrix impulse + velocity0, each row either clamped (velocity 0) or at
// a bound of its impulse. Rows enter one by one (Baraff 1994): the impulse of a new row grows from zero, the clamped rows keep
// their velocities at zero, and a row that reaches a bound on the way changes its state.
class Pivoting {
 public:
  Pivoting(LcpWorkspace& space, std::size_t rows) : s_(space), rows_(rows) {}

  // Drives row `row` into the solution. If that takes too many pivots, because the method cycles, the row is left as it is.
  void drive(std::size_t row) {
    if (s_.least[row] == 0.0 && s_.velocity[row] >= -tuning::kLcpZeroSpeed_m_s) return;
    for (std::size_t pivot = 0; pivot < tuning::kMaxLcpPivotsPerRow * rows_; ++pivot) {
      if (std::abs(s_.velocity[row]) <= tuning::kLcpZeroSpeed_m_s) {
        clamp(row);
        return;
      }
      if (stepTowards(row)) return;
    }
  }

 private:
  [[nodiscard]] double a(std::size_t i, std::size_t j) const { return s_.matrix[i * rows_ + j]; }
  double& inverse(std::size_t i, std::size_t j) { return s_.inverse[i * rows_ + j]; }

  // One step of driving: as far as the first blocking row allows. Returns whether the driven row has reached its final state.
  bool stepTowards(std::size_t row) {
    const double way = s_.velocity[row] < 0.0 ? 1.0 : -1.0;
    changesFor(row, way);
    // The driven row itself: to velocity zero, or to a bound.
    double longest = -s_.velocity[row] / s_.velocityChange[row];
    std::size_t first = row;
    bool bounded = false;
    const double bound = way > 0.0 ? s_.most[row] : s_.least[row];
    if (std::abs(bound - s_.impulse[row]) < longest) {
      longest = std::abs(bound - s_.impulse[row]);
      bounded = true;
    }
    for (std::size_t j = 0; j < row; ++j) {  // later rows have not entered yet
      double reach = std::numeric_limits<double>::infinity();
      if (s_.placeOf[j] >= 0) {
        const double change = s_.impulseChange[j];
        if (change < 0.0) reach = (s_.least[j] - s_.impulse[j]) / change;
        if (change > 0.0) reach = (s_.most[j] - s_.impulse[j]) / change;
      } else if (s_.least[j] < s_.most[j]) {
        const bool low = s_.impulse[j] <= s_.least[j];
        const double change = s_.velocityChange[j];
        if (low ? change < 0.0 : change > 0.0) reach = -s_.velocity[j] / change;
      }
      if (std::max(0.0, reach) < longest) {
        longest = std::max(0.0, reach);
        first = j;
      }
    }
    for (const std::int32_t j : s_.clamped)
      s_.impulse[static_cast<std::size_t>(j)] += longest * s_.impulseChange[static_cast<std::size_t>(j)];
    s_.impulse[row] += longest * way;
    for (std::size_t j = 0; j < rows_; ++j) s_.velocity[j] += longest * s_.velocityChange[j];
    if (first == row) {
      if (bounded) {
        s_.impulse[row] = bound;
      } else {
        clamp(row);
      }
      return true;
    }
    if (s_.placeOf[first] >= 0) {
      s_.impulse[first] = s_.impulseChange[first] < 0.0 ? s_.least[first] : s_.most[first];
      release(first);
    } else {
      clamp(first);
    }
    return false;
  }

  // Changes of impulses and velocities per unit of the driven row's impulse.
  void changesFor(std::size_t row, double way) {
    const std::size_t count = s_.clamped.size();
    for (std::size_t i = 0; i < count; ++i) {
      double sum = 0.0;
      for (std::size_t k = 0; k < count; ++k) sum += inverse(i, k) * a(static_cast<std::size_t>(s_.clamped[k]), row);
      s_.impulseChange[static_cast<std::size_t>(s_.clamped[i])] = -way * sum;
    }
    for (std::size_t j = 0; j < rows_; ++j) {
      if (s_.placeOf[j] >= 0) {
        s_.velocityChange[j] = 0.0;
        continue;
      }
      double sum = way * a(j, row);
      for (const std::int32_t k : s_.clamped)
        sum += a(j, static_cast<std::size_t>(k)) * s_.impulseChange[static_cast<std::size_t>(k)];
      s_.velocityChange[j] = sum;
    }
  }

  // Adds a row to the inverse by bordering it.
  void clamp(std::size_t row) {
    const std::size_t count = s_.clamped.size();
    double rest = a(row, row);
    for (std::size_t i = 0; i < count; ++i) {
      double sum = 0.0;
      for (std::size_t k = 0; k < count; ++k) sum += inverse(i, k) * a(static_cast<std::size_t>(s_.clamped[k]), row);
      s_.column[i] = sum;
      rest -= a(row, static_cast<std::size_t>(s_.clamped[i])) * sum;
    }
    for (std::size_t i = 0; i < count; ++i) {
      for (std::size_t k = 0; k < count; ++k) inverse(i, k) += s_.column[i] * s_.column[k] / rest;
      inverse(i, count) = inverse(count, i) = -s_.column[i] / rest;
    }
    inverse(count, count) = 1.0 / rest;
    s_.placeOf[row] = static_cast<std::int32_t>(count);
    s_.clamped.push_back(static_cast<std::int32_t>(row));
    s_.velocity[row] = 0.0;
  }

  // Removes a row: swaps it with the last one, and removes that one's border.
  void release(std::size_t row) {
    const auto place = static_cast<std::size_t>(s_.placeOf[row]);
    const std::size_t last = s_.clamped.size() - 1;
    if (place != last) {
      for (std::size_t k = 0; k <= last; ++k) std::swap(inverse(place, k), inverse(last, k));
      for (std::size_t k = 0; k <= last; ++k) std::swap(inverse(k, place), inverse(k, last));
      std::swap(s_.clamped[place], s_.clamped[last]);
      s_.placeOf[static_cast<std::size_t>(s_.clamped[place])] = static_cast<std::int32_t>(place);
    }
    s_.clamped.pop_back();
    s_.placeOf[row] = -1;
    const double corner = inverse(last, last);
    for (std::size_t i = 0; i < last; ++i) {
      const double share = inverse(i, last) / corner;
      for (std::size_t k = 0; k < last; ++k) inverse(i, k) -= share * inverse(last, k);
    }
  }

  LcpWorkspace& s_;
  std::size_t rows_;
};

// The contact and direction of a row: first all normals, then each contact's two tangents.
struct ConstraintRow {
  std::size_t contact;
  std::size_t direction;
};

ConstraintRow rowAt(std::size_t row, std::size_t contacts) {
  if (row < contacts) return {row, 0};
  return {(row - contacts) / 2, 1 + (row - contacts) % 2};
}

// Velocity along `p` at one contact by a unit impulse along `q` at another, 1/kg.
double coupling(const RigidIsland& island, const RigidContact& at, const Vec3& p, const RigidContact& from, const Vec3& q) {
  double sum = 0.0;
  const auto through = [&](std::int32_t body, const Vec3& armAt, double signAt) {
    if (body < 0 || (body != from.upper && body != from.lower)) return;
    const RigidBody& between = island.bodies[static_cast<std::size_t>(body)];
    const Vec3& armFrom = body == from.upper ? from.armUpper : from.armLower;
    const double sign = body == from.upper ? signAt : -signAt;
    sum += sign * (between.inverseMass * p.dot(q) + armAt.cross(p).dot(between.inverseInertia * armFrom.cross(q)));
  };
  through(at.upper, at.armUpper, 1.0);
  through(at.lower, at.armLower, -1.0);
  return sum;
}

// Matrix, and velocities without contact impulses: row by row, the effect of a unit impulse along one row on all.
void assemble(IslandStep& step, RigidIsland& island) {
  LcpWorkspace& s = island.pivoting;
  const std::size_t contacts = island.contacts.size();
  const std::size_t rows = 3 * contacts;
  s.matrix.assign(rows * rows, 0.0);
  s.inverse.resize(rows * rows);
  for (std::vector<double>* values : {&s.impulse, &s.velocity, &s.least, &s.most, &s.impulseChange, &s.velocityChange, &s.column})
    values->assign(rows, 0.0);
  s.clamped.clear();
  s.clamped.reserve(rows);
  s.placeOf.assign(rows, -1);
  for (std::size_t i = 0; i < rows; ++i) {
    const ConstraintRow row = rowAt(i, contacts);
    const RigidContact& contact = island.contacts[row.contact];
    s.velocity[i] = relativeVelocity(island, contact).dot(contact.direction[row.direction]);
    if (row.direction == 0) {
      s.velocity[i] += (contact.gap > 0.0 ? 1.0 : tuning::kLcpBaumgarte) * contact.gap / step.drift_s;
      s.most[i] = std::numeric_limits<double>::infinity();
    }
    for (std::size_t j = 0; j <= i; ++j) {
      const ConstraintRow column = rowAt(j, contacts);
      s.matrix[i * rows + j] = s.matrix[j * rows + i] =
          coupling(island, contact, contact.direction[row.direction], island.contacts[column.contact],
                   island.contacts[column.contact].direction[column.direction]);
    }
    s.matrix[i * rows + i] *= 1.0 + tuning::kLcpSoftness;
  }
}

// Bounds friction by the normal impulses of the problem without friction, one bound for each tangent: a pyramid, not a cone.
void boundTangents(RigidIsland& island) {
  LcpWorkspace& s = island.pivoting;
  const std::size_t contacts = island.contacts.size();
  for (std::size_t row = contacts; row < 3 * contacts; ++row) {
    const ConstraintRow at = rowAt(row, contacts);
    s.most[row] = island.contacts[at.contact].coefficient * s.impulse[at.contact];
    s.least[row] = -s.most[row];
  }
}

}  // namespace

// Contact impulses as a linear complementarity problem, solved by Dantzig pivoting (Baraff 1994; the report's 2.4.2 and 3.4.1):
// first the normals alone, then friction within bounds that follow from them.
void stepRigidLcp(IslandStep& step, RigidIsland& island) {
  applyForces(step);
  assemble(step, island);
  LcpWorkspace& s = island.pivoting;
  const std::size_t contacts = island.contacts.size();
  Pivoting pivoting(s, 3 * contacts);
  for (std::size_t row = 0; row < 3 * contacts; ++row) {
    if (row == contacts) boundTangents(island);
    pivoting.drive(row);
    ++step.counters.contactEvaluations;
  }
  for (std::size_t i = 0; i < contacts; ++i) {
    RigidContact& contact = island.contacts[i];
    contact.impulse = {s.impulse[i], s.impulse[contacts + 2 * i], s.impulse[contacts + 2 * i + 1]};
    const double across = std::max(std::abs(contact.impulse[1]), std::abs(contact.impulse[2]));
    contact.sliding = across >= contact.coefficient * contact.impulse[0];
    applyImpulse(island, contact,
                 contact.impulse[0] * contact.direction[0] + contact.impulse[1] * contact.direction[1] +
                     contact.impulse[2] * contact.direction[2]);
  }
  markPushed(step, island);
  for (RigidBody& body : island.bodies) moveInStep(step, body);
}

}  // namespace springtower
