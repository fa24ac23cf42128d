#include "narrowphase/exact/exact_integer.h"

#include "core/random.h"
#include "narrowphase/exact/exact_polynomial.h"

#include <gtest/gtest.h>

namespace springtower {
namespace {

__extension__ typedef __int128 Wide;

Integer<3> integerOf(Wide value) {
  const auto high = static_cast<std::int64_t>(value >> 64);
  const auto low = static_cast<std::uint64_t>(value);
  return shiftedLeft<3>(Integer<1>(high), 64) + shiftedLeft<3>(Integer<1>(static_cast<std::int64_t>(low >> 32)), 32) +
         Integer<1>(static_cast<std::int64_t>(low & 0xffffffffU));
}

template <std::size_t A, std::size_t B>
bool isEqual(const Integer<A>& a, const Integer<B>& b) {
  return (a - b).sign() == 0;
}

/// Numbers of all lengths up to 62 bits, of both signs.
std::int64_t randomNumber(SplitMix64& random) {
  const auto bits = static_cast<std::int64_t>(random() >> 2U) >> (random() % 63U);
  return random() % 2U == 0U ? bits : -bits;
}

TEST(ExactInteger, AgreesWith128BitArithmetic) {
  SplitMix64 random(1);
  for (int n = 0; n < 100000; ++n) {
    const std::int64_t a = randomNumber(random), b = randomNumber(random), c = randomNumber(random);
    const Integer<1> x(a), y(b), z(c);
    const Wide value = static_cast<Wide>(a) * b - c;
    const auto result = x * y - z;
    ASSERT_TRUE(isEqual(result, integerOf(value)));
    ASSERT_EQ(result.sign(), value > 0 ? 1 : (value < 0 ? -1 : 0));
    ASSERT_TRUE(isEqual(halved(result), integerOf(value / 2)));
    ASSERT_TRUE(isEqual(shiftedLeft<4>(result, 77), result * shiftedLeft<3>(Integer<1>(1), 77)));
  }
}

TEST(ExactInteger, LongNumbersObeyTheRulesOfArithmetic) {
  SplitMix64 random(2);
  for (int n = 0; n < 2000; ++n) {
    Integer<20> a, b, c;
    for (Integer<20>* number : {&a, &b, &c}) {
      for (std::uint64_t limb = 0; limb < 1 + random() % 18U; ++limb) {
        // Limbs of ones and of zeros give the longest carries and borrows.
        const std::int64_t part = random() % 3U == 0U ? randomNumber(random) : (random() % 2U == 0U ? 0 : -1);
        *number = shiftedLeft<20>(*number, 64) + Integer<1>(part);
      }
    }
    ASSERT_TRUE(isEqual((a + b) * (a - b), a * a - b * b));
    ASSERT_TRUE(isEqual((a + b) * c, c * a + c * b));
    ASSERT_TRUE(isEqual(a - b + b, a));
    ASSERT_EQ((a - a).sign(), 0);
    ASSERT_EQ(compareMagnitudes(a, b), (a * a - b * b).sign());
  }
}

TEST(ExactInteger, RoundsDownToDouble) {
  const Integer<1> one(1);
  EXPECT_EQ(magnitudeRoundedDown(one, 0), 1.0);
  EXPECT_EQ(magnitudeRoundedDown(one, 1000), 0x1p-1000);
  EXPECT_EQ(magnitudeRoundedDown(Integer<1>(0), 5), 0.0);
  const auto big = shiftedLeft<4>(one, 200);
  EXPECT_EQ(magnitudeRoundedDown(big, 200), 1.0);
  EXPECT_EQ(magnitudeRoundedDown(big - one, 200), std::nextafter(1.0, 0.0));
  EXPECT_EQ(magnitudeRoundedDown(big + one, 200), 1.0);
  EXPECT_EQ(magnitudeRoundedDown(Integer<1>((std::int64_t{1} << 53) + 1), 0), 0x1p53);
}

using exact::Polynomial;

/// The polynomial with the roots numerator / denominator.
Polynomial<3, 6> cubicWithRoots(const std::array<std::array<std::int64_t, 2>, 3>& roots) {
  Polynomial<3, 6> product{{Integer<1>(1), {}, {}, {}}};
  for (const auto& [numerator, denominator] : roots) {
    Polynomial<3, 6> next;
    for (std::size_t i = 0; i < 4; ++i) {
      next.coefficients[i] = -(product.coefficients[i] * Integer<1>(numerator));
      if (i > 0) next.coefficients[i] = next.coefficients[i] + product.coefficients[i - 1] * Integer<1>(denominator);
    }
    product = next;
  }
  return product;
}

TEST(ExactPolynomial, FindsEachRootOnceInOrderAndRoundsItDown) {
  const auto roots = [](const Polynomial<3, 6>& cubic) {
    std::vector<double> times;
    exact::visitRoots(cubic, [&](auto root) {
      times.push_back(exact::roundedDown(root));
      return false;
    });
    return times;
  };
  const double third = 1.0 / 3.0;  // the nearest double is below a third
  EXPECT_EQ(roots(cubicWithRoots({{{1, 3}, {1, 2}, {3, 4}}})), (std::vector<double>{third, 0.5, 0.75}));
  EXPECT_EQ(roots(cubicWithRoots({{{0, 1}, {1, 1}, {2, 1}}})), (std::vector<double>{0.0, 1.0}));
  EXPECT_EQ(roots(cubicWithRoots({{{1, 3}, {1, 3}, {1, 3}}})), (std::vector<double>{third}));
  EXPECT_EQ(roots(cubicWithRoots({{{1, 3}, {1, 3}, {3, 4}}})), (std::vector<double>{third, 0.75}));
  EXPECT_EQ(roots(cubicWithRoots({{{-1, 3}, {5, 4}, {7, 4}}})), (std::vector<double>{}));
  // Two roots 2^-60 apart, closer than neighbouring doubles.
  const std::int64_t close = std::int64_t{1} << 60;
  EXPECT_EQ(roots(cubicWithRoots({{{close / 2 + 1, close}, {1, 2}, {2, 1}}})), (std::vector<double>{0.5, 0.5}));
  // A root next to one at the end of the step.
  const std::int64_t fine = std::int64_t{1} << 45;
  EXPECT_EQ(roots(cubicWithRoots({{{0, 1}, {1, fine}, {2, 1}}})), (std::vector<double>{0.0, 0x1p-45}));
  EXPECT_EQ(roots(cubicWithRoots({{{1, 1}, {fine - 1, fine}, {2, 1}}})), (std::vector<double>{1.0 - 0x1p-45, 1.0}));
  // 2 t^2 - 1 and 2 t^3 - 1: irrational; the double nearest to the root of 1/2 is above it.
  EXPECT_EQ(roots({{Integer<1>(-1), {}, Integer<1>(2), {}}}), (std::vector<double>{std::nextafter(std::sqrt(0.5), 0.0)}));
  EXPECT_EQ(roots({{Integer<1>(-1), {}, {}, Integer<1>(2)}}).size(), 1u);
  EXPECT_NEAR(roots({{Integer<1>(-1), {}, {}, Integer<1>(2)}}).front(), std::cbrt(0.5), 1e-15);
}

TEST(ExactPolynomial, DecidesSignsAtIrrationalRoots) {
  // At the root of 2 t^2 - 1 (0.7071...).
  const Polynomial<2, 2> square{{Integer<1>(-1), {}, Integer<1>(2)}};
  // 408/577 is the nearest fraction for its size: 2 * 408^2 - 577^2 = -1, so the root is larger.
  const Polynomial<1, 1> convergent{{Integer<1>(-408), Integer<1>(577)}};
  // 2 t^2 - 1 times anything is zero there, and t^2 - 1/2 + (t - 408/577) is not.
  const Polynomial<2, 2> twice{{Integer<1>(-3), {}, Integer<1>(6)}};
  const Polynomial<2, 2> shifted{{Integer<1>(-409), Integer<1>(577), Integer<1>(2)}};
  int visited = 0;
  exact::visitRoots(square, [&](auto root) {
    ++visited;
    EXPECT_EQ(exact::signAtRoot(convergent, root), 1);
    EXPECT_EQ(exact::signAtRoot(twice, root), 0);
    EXPECT_EQ(exact::signAtRoot(shifted, root), 1);
    EXPECT_EQ(exact::signAtRoot(Polynomial<2, 2>{}, root), 0);
    return false;
  });
  EXPECT_EQ(visited, 1);
  // (2 t^2 - 1)(3 t - 1) shares both roots with other polynomials.
  const Polynomial<3, 2> cubic{{Integer<1>(1), Integer<1>(-3), Integer<1>(-2), Integer<1>(6)}};
  std::vector<std::array<int, 3>> signs;
  exact::visitRoots(cubic, [&](auto root) {
    const Polynomial<1, 1> linear{{Integer<1>(-1), Integer<1>(3)}};
    const Polynomial<2, 2> common{{Integer<1>(-1), Integer<1>(2), Integer<1>(3)}};  // (3 t - 1)(t + 1)
    signs.push_back({exact::signAtRoot(linear, root), exact::signAtRoot(square, root), exact::signAtRoot(common, root)});
    return false;
  });
  EXPECT_EQ(signs, (std::vector<std::array<int, 3>>{{0, -1, 0}, {1, 0, 1}}));
}

TEST(ExactPolynomial, SignOfAFactorWithoutRealRoots) {
  // (1000 t - 501) (2^k (2 t - 1)^2 + 1): the second factor comes close to zero beside the root and is positive.
  for (std::uint32_t k = 0; k < 40; k += 3) {
    const Integer<1> one(1), size(std::int64_t{1} << k);
    const Polynomial<2, 2> factor{{size + one, -(Integer<1>(4) * size), Integer<1>(4) * size}};
    const auto& [c, b, a] = factor.coefficients;
    const Integer<1> slope(1000), constant(-501);
    const Polynomial<3, 3> product{{constant * c, constant * b + slope * c, constant * a + slope * b, slope * a}};
    int visited = 0;
    exact::visitRoots(product, [&](auto root) {
      ++visited;
      EXPECT_EQ(exact::signAtRoot(factor, root), 1) << k;
      return false;
    });
    EXPECT_EQ(visited, 1);
  }
}

}  // namespace
}  // namespace springtower
