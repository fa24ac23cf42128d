#pragma once

#include "narrowphase/exact/exact_integer.h"

#include <algorithm>
#include <array>
#include <cstdint>

/// Signs of polynomials with integer coefficients, at and between the roots of others, determined without rounding.
namespace springtower::exact {

/// Time is divided into at most 2^kMaxDepth parts. Different roots of the polynomials of one query are separated at a much
/// smaller depth; if not, they count as equal, which can only turn a miss by 2^-1024 of the step into a contact.
constexpr std::uint32_t kMaxDepth = 1024;
constexpr std::size_t kTimeCapacity = kMaxDepth / 64 + 1;

/// Sum of coefficients[i] t^i.
template <int Degree, std::size_t Capacity>
struct Polynomial {
  std::array<Integer<Capacity>, Degree + 1> coefficients;

  /// The degree without leading zeros, -1 for the zero polynomial.
  int degree() const {
    int degree = Degree;
    while (degree >= 0 && coefficients[static_cast<std::size_t>(degree)].size == 0) --degree;
    return degree;
  }
};

/// The time index / 2^depth, or the open interval from it to (index + 1) / 2^depth.
struct DyadicTime {
  Integer<kTimeCapacity> index;
  std::uint32_t depth = 0;
  bool isPoint = false;
};

/// One root of a polynomial without multiple roots: the time itself, or an open interval that contains no other root of it.
template <int Degree, std::size_t Capacity>
struct Root {
  const Polynomial<Degree, Capacity>* polynomial;
  DyadicTime at;
  int signBefore = 0;  ///< of the polynomial, between the start of the interval and the root
};

/// Sign of a polynomial at numerator / denominator, denominator > 0.
template <int Degree, std::size_t Capacity, std::size_t Fraction>
int signAtFraction(const Polynomial<Degree, Capacity>& polynomial, const Integer<Fraction>& numerator,
                   const Integer<Fraction>& denominator) {
  using Value = Integer<Capacity + Degree * Fraction>;
  Value value = polynomial.coefficients[Degree];
  Integer<(Degree + 1)* Fraction> power = 1;
  for (int i = Degree - 1; i >= 0; --i) {
    power = power * denominator;
    value = value * numerator + polynomial.coefficients[static_cast<std::size_t>(i)] * power;
  }
  return value.sign();
}

/// Coefficients of the polynomial in s, with time = (index + s) / 2^depth, all multiplied by 2^(depth * Degree).
template <int Degree, std::size_t Capacity>
std::array<Integer<Capacity + Degree * kTimeCapacity>, Degree + 1> taylorCoefficients(
    const Polynomial<Degree, Capacity>& polynomial, const DyadicTime& time) {
  // By repeated Horner steps. They stay below 8 * 2^(depth * Degree) times the largest coefficient.
  std::array<Integer<Capacity + Degree * kTimeCapacity>, Degree + 1> taylor;
  for (std::size_t i = 0; i <= Degree; ++i)
    taylor[i] = shiftedLeft<Capacity + Degree * kTimeCapacity>(polynomial.coefficients[i],
                                                               time.depth * static_cast<std::uint32_t>(Degree - i));
  if (time.index.size != 0)
    for (std::size_t i = 0; i < Degree; ++i)
      for (std::size_t j = Degree; j-- > i;) taylor[j] = taylor[j] + time.index * taylor[j + 1];
  return taylor;
}

/// Signs of the Bernstein coefficients of a polynomial on [index, index + 1] / 2^depth. The first and the last are its signs at
/// the ends; if all agree, that is its sign on the whole interval.
template <int Degree, std::size_t Capacity>
std::array<int, Degree + 1> bernsteinSigns(const Polynomial<Degree, Capacity>& polynomial, const DyadicTime& time) {
  static_assert(Degree >= 1 && Degree <= 3);
  const auto taylor = taylorCoefficients(polynomial, time);
  if constexpr (Degree == 1) {
    return {taylor[0].sign(), (taylor[0] + taylor[1]).sign()};
  } else if constexpr (Degree == 2) {
    const auto first = taylor[0] + taylor[1];
    return {taylor[0].sign(), (taylor[0] + first).sign(), (first + taylor[2]).sign()};
  } else {
    const auto first = taylor[0] + taylor[1];
    return {taylor[0].sign(), (taylor[0] + taylor[0] + first).sign(), (taylor[0] + first + first + taylor[2]).sign(),
            (first + taylor[2] + taylor[3]).sign()};
  }
}

/// Sign of a polynomial at index / 2^depth.
template <int Degree, std::size_t Capacity>
int signAtStart(const Polynomial<Degree, Capacity>& polynomial, const DyadicTime& time) {
  constexpr std::size_t kValue = Capacity + Degree * kTimeCapacity;
  Integer<kValue> value = polynomial.coefficients[Degree];
  for (std::size_t i = Degree; i-- > 0;)
    value =
        value * time.index + shiftedLeft<kValue>(polynomial.coefficients[i], time.depth * static_cast<std::uint32_t>(Degree - i));
  return value.sign();
}

/// Number of sign changes in a sequence, zeros omitted. For Bernstein coefficients it is the number of roots in the open
/// interval, or larger by an even number (Descartes' rule).
template <std::size_t Size>
int signVariations(const std::array<int, Size>& signs) {
  int variations = 0;
  int last = 0;
  for (const int sign : signs) {
    if (sign == 0) continue;
    variations += last == -sign;
    last = sign;
  }
  return variations;
}

/// Calls visit(root) for the roots in [0, 1] of a polynomial that has no multiple roots and is not zero, in the order of time,
/// until it returns true; returns whether it did.
template <int Degree, std::size_t Capacity, class Visit>
bool visitSimpleRoots(const Polynomial<Degree, Capacity>& polynomial, Visit&& visit) {
  DyadicTime part;
  std::array<int, Degree + 1> signs;
  for (;;) {
    signs = bernsteinSigns(polynomial, part);
    if (signs[0] == 0 && visit(Root<Degree, Capacity>{&polynomial, {part.index, part.depth, true}})) return true;
    const int variations = signVariations(signs);
    if (variations > 1 && part.depth < kMaxDepth) {
      part.index = shiftedLeft<kTimeCapacity>(part.index, 1);
      ++part.depth;
      continue;
    }
    if (variations > 0) {
      int signBefore = 0;
      for (const int sign : signs) signBefore = signBefore == 0 ? sign : signBefore;
      if (visit(Root<Degree, Capacity>{&polynomial, part, signBefore})) return true;
    }
    while (part.index.size != 0 && (part.index.limbs[0] & 1) != 0) {
      part.index = halved(part.index);
      --part.depth;
    }
    if (part.depth == 0) break;
    part.index = part.index + Integer<1>(1);
  }
  return signs[Degree] == 0 && visit(Root<Degree, Capacity>{&polynomial, {Integer<1>(1), 0, true}});
}

/// Calls visit(root) for the roots in [0, 1] of a polynomial, each once, whatever its multiplicity; none if it is zero. A
/// polynomial with multiple roots is first replaced by ones without: up to degree 3, a multiple root is rational, and so is one
/// beside it. The calls stop at the first root of each of these for which visit returns true.
template <std::size_t Capacity, class Visit>
void visitRoots(const Polynomial<1, Capacity>& polynomial, Visit&& visit) {
  if (polynomial.degree() == 1) visitSimpleRoots(polynomial, visit);
}

template <std::size_t Capacity, class Visit>
void visitRoots(const Polynomial<2, Capacity>& polynomial, Visit&& visit) {
  const auto& [c, b, a] = polynomial.coefficients;
  if (a.size == 0) return visitRoots(Polynomial<1, Capacity>{{c, b}}, visit);
  const auto discriminant = b * b - Integer<1>(4) * (a * c);
  if (discriminant.sign() > 0) visitSimpleRoots(polynomial, visit);
  if (discriminant.sign() == 0) visitRoots(Polynomial<1, Capacity>{{b, a + a}}, visit);
}

template <std::size_t Capacity, class Visit>
void visitRoots(const Polynomial<3, Capacity>& polynomial, Visit&& visit) {
  const auto& [d, c, b, a] = polynomial.coefficients;
  if (a.size == 0) return visitRoots(Polynomial<2, Capacity>{{d, c, b}}, visit);
  using Small = Integer<1>;
  const auto ac = a * c, bb = b * b, bc = b * c, ad = a * d;
  const auto discriminant =
      Small(18) * (ad * bc) - Small(4) * (bb * (b * d)) + bc * bc - Small(4) * (ac * (c * c)) - Small(27) * (ad * ad);
  if (discriminant.sign() != 0) {
    visitSimpleRoots(polynomial, visit);
    return;
  }
  const auto spread = bb - Small(3) * ac;
  if (spread.sign() == 0) return visitRoots(Polynomial<1, Capacity>{{b, Small(3) * a}}, visit);
  visitRoots(Polynomial<1, 2 * Capacity>{{bc - Small(9) * ad, spread + spread}}, visit);
  visitRoots(Polynomial<1, 3 * Capacity>{{b * bb + Small(9) * (a * ad) - Small(4) * (b * ac), a * spread}}, visit);
}

constexpr std::uint32_t kGuessedBits = 40;

/// The first kGuessedBits binary digits of s of a root that is not a point, at (index + s) / 2^depth, by bisection in floating
/// point. Usually right, but only a guess.
template <int Degree, std::size_t Capacity>
std::int64_t guessDigits(const Root<Degree, Capacity>& root) {
  const auto taylor = taylorCoefficients(*root.polynomial, root.at);
  std::uint32_t bits = 0;
  for (const auto& coefficient : taylor) bits = std::max(bits, bitLength(coefficient));
  std::array<double, Degree + 1> scaled;
  for (std::size_t i = 0; i <= Degree; ++i)
    scaled[i] = root.signBefore * taylor[i].sign() * magnitudeRoundedDown(taylor[i], bits);
  double low = 0.0;
  for (double step = 0.5; step >= std::ldexp(1.0, -static_cast<int>(kGuessedBits)); step *= 0.5) {
    double value = scaled[Degree];
    for (std::size_t i = Degree; i-- > 0;) value = value * (low + step) + scaled[i];
    if (value > 0.0) low += step;
  }
  return static_cast<std::int64_t>(std::ldexp(low, static_cast<int>(kGuessedBits)));
}

/// Makes the interval of a root that is not a point 2^kGuessedBits times smaller if a guess in floating point holds, otherwise
/// halves it. Which part holds the root is decided by exact signs at its ends; a root at one of them becomes a point.
template <int Degree, std::size_t Capacity>
void refine(Root<Degree, Capacity>& root) {
  constexpr std::int64_t kCells = std::int64_t{1} << kGuessedBits;
  if (root.at.depth + kGuessedBits <= kMaxDepth) {
    const std::int64_t cell = guessDigits(root);
    const DyadicTime start{shiftedLeft<kTimeCapacity>(root.at.index, kGuessedBits) + Integer<1>(cell),
                           root.at.depth + kGuessedBits};
    const DyadicTime end{start.index + Integer<1>(1), start.depth};
    // There may be another root at the ends of the old interval; the sign just inside is the relevant one.
    const int signAtFirst = cell == 0 ? root.signBefore : signAtStart(*root.polynomial, start);
    const int signAtLast = cell == kCells - 1 ? -root.signBefore : signAtStart(*root.polynomial, end);
    if (signAtFirst != -root.signBefore && signAtLast != root.signBefore) {
      root.at = signAtFirst != 0 && signAtLast == 0 ? end : start;
      root.at.isPoint = signAtFirst == 0 || signAtLast == 0;
      return;
    }
  }
  DyadicTime middle{shiftedLeft<kTimeCapacity>(root.at.index, 1) + Integer<1>(1), root.at.depth + 1};
  const int sign = signAtStart(*root.polynomial, middle);
  if (sign == -root.signBefore) middle.index = middle.index - Integer<1>(1);
  middle.isPoint = sign == 0;
  root.at = middle;
}

/// Whether numerator / denominator lies in the open interval.
template <std::size_t Fraction>
bool isInside(const Integer<Fraction>& numerator, const Integer<Fraction>& denominator, const DyadicTime& interval) {
  const auto scaled = shiftedLeft<Fraction + kTimeCapacity>(numerator, interval.depth);
  const auto fromStart = scaled - interval.index * denominator;
  return fromStart.sign() == denominator.sign() && (denominator - fromStart).sign() == denominator.sign();
}

/// Whether a polynomial of degree 1 or 2 is zero at a root of another one (of degree 2 or 3), given as an open interval.
template <std::size_t Capacity, int RootDegree, std::size_t RootCapacity>
bool vanishesAt(const Polynomial<2, Capacity>& polynomial, const Root<RootDegree, RootCapacity>& root) {
  const auto& [q0, q1, q2] = polynomial.coefficients;
  if (polynomial.degree() < 1) return polynomial.degree() < 0;
  if (polynomial.degree() == 1)
    return isInside(-q0, q1, root.at) && signAtFraction(*root.polynomial, q1.negative ? q0 : -q0, q1.negative ? -q1 : q1) == 0;

  // A common root is a root of the remainder p mod q, which has at most one unless q divides p.
  constexpr std::size_t kRemainder = RootCapacity + 2 * Capacity;
  std::array<Integer<kRemainder>, RootDegree + 1> rest;
  std::copy(root.polynomial->coefficients.begin(), root.polynomial->coefficients.end(), rest.begin());
  for (std::size_t top = RootDegree; top >= 2; --top) {
    for (std::size_t i = 0; i < top; ++i) {
      rest[i] = q2 * rest[i];
      if (i + 2 == top) rest[i] = rest[i] - q0 * rest[top];
      if (i + 1 == top) rest[i] = rest[i] - q1 * rest[top];
    }
  }
  if (rest[1].size == 0) return rest[0].size == 0 && signVariations(bernsteinSigns(polynomial, root.at)) == 1;
  if (!isInside(-rest[0], rest[1], root.at)) return false;
  return signAtFraction(polynomial, rest[1].negative ? rest[0] : -rest[0], rest[1].negative ? -rest[1] : rest[1]) == 0;
}

/// Sign of a polynomial at a root of another one; the root's interval is refined as far as needed. 0 also if kMaxDepth is
/// reached.
template <int Degree, std::size_t Capacity, int RootDegree, std::size_t RootCapacity>
int signAtRoot(const Polynomial<Degree, Capacity>& polynomial, Root<RootDegree, RootCapacity>& root) {
  if (root.at.isPoint) return signAtStart(polynomial, root.at);
  if constexpr (RootDegree == 1) {
    const auto& [constant, slope] = root.polynomial->coefficients;
    return signAtFraction(polynomial, slope.negative ? constant : -constant, slope.negative ? -slope : slope);
  } else if constexpr (Degree == 1) {
    return signAtRoot(Polynomial<2, Capacity>{{polynomial.coefficients[0], polynomial.coefficients[1], {}}}, root);
  } else {
    for (bool compared = false;; compared = true) {
      if (root.at.isPoint) return signAtStart(polynomial, root.at);
      const std::array<int, Degree + 1> signs = bernsteinSigns(polynomial, root.at);
      int sum = 0;
      for (const int sign : signs) sum += sign;
      if (sum == Degree + 1 || sum == -(Degree + 1)) return signs[0];
      if (!compared && vanishesAt(polynomial, root)) return 0;
      if (root.at.depth == kMaxDepth) return 0;
      refine(root);
    }
  }
}

/// The largest double not later than a root (for one within 2^-1022 of 0: not later).
template <int Degree, std::size_t Capacity>
double roundedDown(Root<Degree, Capacity>& root) {
  constexpr std::uint32_t kDigits = 54;
  while (!root.at.isPoint && bitLength(root.at.index) < kDigits && root.at.depth < kMaxDepth) refine(root);
  return magnitudeRoundedDown(root.at.index, root.at.depth);
}

}  // namespace springtower::exact
