// Rows in pages: each has one owner until it is returned, and a copy has the contents of the original.
#include "solver/world/page_pool.h"

#include <cstdint>
#include <gtest/gtest.h>
#include <oneapi/tbb/parallel_for.h>
#include <set>
#include <vector>

namespace springtower {
namespace {

struct NumberPage {
  Column<int> number{};
  bool isWide = false;
  void prepare(bool wide) { isWide = wide; }
};
using NumberPool = PagePool<NumberPage>;

int& numberOf(NumberPool& pool, std::int32_t row) {
  return pool.page(row).number[NumberPool::slot(row)];
}

TEST(PagePool, GivesEachRowToOneOwner) {
  NumberPool pool;
  pool.reserve(10, 1000, false);
  std::set<std::int32_t> taken;
  for (int i = 0; i < 300; ++i) EXPECT_TRUE(taken.insert(pool.take()).second);  // more than were reserved: pages are allocated
  EXPECT_EQ(pool.rowsInUse(), 300U);
  for (const std::int32_t row : taken) pool.giveBack(row);
  EXPECT_EQ(pool.rowsInUse(), 0U);
}

TEST(PagePool, GivesEachRowToOneOwnerOnManyThreads) {
  constexpr std::size_t kRows = 5000;
  NumberPool pool;
  pool.reserve(100, kRows, false);
  std::vector<std::int32_t> rows(kRows);
  tbb::parallel_for(std::size_t{0}, kRows, [&](std::size_t i) {
    rows[i] = pool.take();
    numberOf(pool, rows[i]) = static_cast<int>(i);
  });
  EXPECT_EQ(std::set<std::int32_t>(rows.begin(), rows.end()).size(), kRows);
  for (std::size_t i = 0; i < kRows; ++i) EXPECT_EQ(numberOf(pool, rows[i]), static_cast<int>(i));
}

TEST(PagePool, TakesRowsAgainThatWereGivenBack) {
  NumberPool pool;
  pool.reserve(1, 200, false);
  std::vector<std::int32_t> rows;
  for (int i = 0; i < 100; ++i) rows.push_back(pool.take());
  for (const std::int32_t row : rows) pool.giveBack(row);
  const std::size_t pages = pool.pageCount();
  for (int i = 0; i < 100; ++i) rows[static_cast<std::size_t>(i)] = pool.take();
  EXPECT_EQ(pool.pageCount(), pages);
  EXPECT_EQ(std::set<std::int32_t>(rows.begin(), rows.end()).size(), 100U);
}

// A snapshot is assigned to a pool that has grown since: its contents are restored, and the additional pages of the pool stay,
// free.
TEST(PagePool, KeepsItsPagesWhenACopyIsAssigned) {
  NumberPool pool;
  pool.reserve(1, 1000, false);
  const std::int32_t first = pool.take();
  numberOf(pool, first) = 7;
  const NumberPool copy = pool;
  for (int i = 0; i < 500; ++i) numberOf(pool, pool.take()) = 8;
  numberOf(pool, first) = 9;
  const std::size_t pages = pool.pageCount();
  pool = copy;
  EXPECT_EQ(numberOf(pool, first), 7);
  EXPECT_EQ(pool.rowsInUse(), 1U);
  std::set<std::int32_t> taken{first};
  for (int i = 0; i < 500; ++i) EXPECT_TRUE(taken.insert(pool.take()).second);
  EXPECT_EQ(pool.pageCount(), pages);
}

// In a pool that has grown while narrow, all pages are prepared after a wide one has been assigned to it.
TEST(PagePool, PreparesAllPagesOnceAWideCopyIsAssigned) {
  NumberPool wide;
  wide.reserve(1, 1000, true);
  NumberPool narrow;
  narrow.reserve(500, 1000, false);
  narrow = wide;
  narrow.reserve(1, 1000, true);
  narrow.forEachPage([](NumberPage& page) { EXPECT_TRUE(page.isWide); });
  EXPECT_GE(narrow.pageCount(), 8U);
}

}  // namespace
}  // namespace springtower
