#include "solver/algebra/elimination_order.h"

#include "solver/algebra/block_ldlt.h"

#include <algorithm>
#include <gtest/gtest.h>
#include <numeric>
#include <random>
#include <vector>

namespace springtower {
namespace {

constexpr std::size_t kMaxProductsHere = 100'000'000;

// A wall in running bond: `rows` rows of `columns` bricks of unit size, each on two of the row below.
struct Coupled {
  std::vector<Vec3> centre;
  std::vector<BlockPair> edges;
};

Coupled wall(std::int32_t columns, std::int32_t rows) {
  Coupled made;
  for (std::int32_t row = 0; row < rows; ++row) {
    for (std::int32_t i = 0; i < columns; ++i) {
      const std::int32_t node = row * columns + i;
      made.centre.emplace_back(i + (row % 2 == 0 ? 0.0 : 0.5), 0.0, row);
      if (row == 0) continue;
      made.edges.push_back({node, node - columns});
      const std::int32_t beside = row % 2 == 0 ? i - 1 : i + 1;
      if (beside >= 0 && beside < columns) made.edges.push_back({node, (row - 1) * columns + beside});
    }
  }
  return made;
}

// `side` by `side` by `side` cubes that touch across all their faces.
Coupled solid(std::int32_t side) {
  Coupled made;
  const auto at = [&](std::int32_t x, std::int32_t y, std::int32_t z) { return (z * side + y) * side + x; };
  for (std::int32_t z = 0; z < side; ++z) {
    for (std::int32_t y = 0; y < side; ++y) {
      for (std::int32_t x = 0; x < side; ++x) {
        made.centre.emplace_back(x, y, z);
        if (x > 0) made.edges.push_back({at(x, y, z), at(x - 1, y, z)});
        if (y > 0) made.edges.push_back({at(x, y, z), at(x, y - 1, z)});
        if (z > 0) made.edges.push_back({at(x, y, z), at(x, y, z - 1)});
      }
    }
  }
  return made;
}

std::vector<std::int32_t> orderOf(const Coupled& nodes) {
  EliminationOrder order;
  order.centre = nodes.centre;
  orderByDissection(nodes.edges, order);
  return order.nodes;
}

std::size_t productsOf(const std::vector<std::int32_t>& order, const Coupled& nodes) {
  BlockCholesky matrix;
  EXPECT_TRUE(analyse(order, nodes.edges, kMaxProductsHere, matrix));
  return matrix.products;
}

std::vector<std::int32_t> bottomUp(const Coupled& nodes) {
  EliminationOrder order;
  order.centre = nodes.centre;
  orderBottomUp(order);
  return order.nodes;
}

TEST(EliminationOrder, NamesEveryNodeOnce) {
  for (const Coupled& nodes : {wall(1, 1), wall(20, 3), wall(61, 1), wall(13, 40), solid(7)}) {
    std::vector<std::int32_t> order = orderOf(nodes);
    std::sort(order.begin(), order.end());
    std::vector<std::int32_t> all(nodes.centre.size());
    std::iota(all.begin(), all.end(), 0);
    EXPECT_EQ(order, all);
  }
}

TEST(EliminationOrder, IsTheSameForAnyOrderOfEdges) {
  Coupled nodes = solid(6);
  const std::vector<std::int32_t> order = orderOf(nodes);
  std::shuffle(nodes.edges.begin(), nodes.edges.end(), std::mt19937_64(1));
  for (BlockPair& edge : nodes.edges) std::swap(edge.a, edge.b);
  EXPECT_EQ(orderOf(nodes), order);
}

// A dissected sheet of n nodes requires a number of products that grows as n^1.5, a band of its rows as n^2 (George 1973): n
// products of 12 x 12 blocks times a factor that was measured here, with a margin of a quarter. Bottom up each node requires
// columns^2 / 2.
TEST(EliminationOrder, FillsInLittleInSheetsAndSolids) {
  const Coupled small = wall(40, 25);
  EXPECT_LT(productsOf(orderOf(small), small), 75U * small.centre.size());
  const Coupled large = wall(80, 50);
  EXPECT_LT(productsOf(orderOf(large), large), 2.4 * 4.0 * static_cast<double>(productsOf(orderOf(small), small)));
  const Coupled cube = solid(12);
  EXPECT_LT(2 * productsOf(orderOf(cube), cube), productsOf(bottomUp(cube), cube));
}

TEST(EliminationOrder, HandlesPartsThatAreNotCoupled) {
  Coupled nodes = wall(10, 10);
  const Coupled other = wall(8, 9);
  for (const Vec3& centre : other.centre) nodes.centre.emplace_back(centre + Vec3(0.25, 3.0, 0.5));
  for (const BlockPair& edge : other.edges) nodes.edges.push_back({edge.a + 100, edge.b + 100});
  const Coupled alone = wall(10, 10);
  EXPECT_LT(productsOf(orderOf(nodes), nodes), 2 * productsOf(orderOf(alone), alone));
}

TEST(BlockCholesky, HoldsThePairsThatItHasBlocksFor) {
  const Coupled nodes = wall(12, 8);
  BlockCholesky matrix;
  ASSERT_TRUE(analyse(orderOf(nodes), nodes.edges, kMaxProductsHere, matrix));
  EXPECT_TRUE(holds(matrix, nodes.edges));
  std::vector<BlockPair> fewer(nodes.edges.begin() + 5, nodes.edges.end());
  EXPECT_TRUE(holds(matrix, fewer));
  fewer.push_back({0, 95});  // opposite corners of the wall
  EXPECT_FALSE(holds(matrix, fewer));
}

}  // namespace
}  // namespace springtower
