// Working data that islands share, one after the other.
#include "solver/world/work_pool.h"

#include "core/parallel.h"
#include "core/reserve_closely.h"

#include <atomic>
#include <cstddef>
#include <gtest/gtest.h>
#include <vector>

namespace springtower {
namespace {

struct Work {
  std::vector<int> kept;
  std::atomic<int> users = 0;
};

std::size_t recordsOf(WorkPool<Work>& pool) {
  std::size_t count = 0;
  pool.forEach([&](Work&) { ++count; });
  return count;
}

TEST(WorkPool, OneAfterTheOtherHaveTheSameRecord) {
  WorkPool<Work> pool;
  const Work* first = nullptr;
  for (int i = 0; i < 3; ++i) {
    const auto taken = pool.take();
    if (first == nullptr) first = &taken.record();
    EXPECT_EQ(&taken.record(), first);
    EXPECT_EQ(taken.record().kept.size(), static_cast<std::size_t>(i)) << "its memory stays";
    taken.record().kept.push_back(i);
  }
  EXPECT_EQ(recordsOf(pool), 1U);
}

// More than there are places for as well.
TEST(WorkPool, AtTheSameTimeAllHaveTheirOwn) {
  WorkPool<Work> pool;
  constexpr int kMany = 300;
  const auto takeAll = [&](const auto& self, int left) -> void {
    const auto taken = pool.take();
    EXPECT_EQ(++taken.record().users, 1);
    if (left > 1) self(self, left - 1);
    --taken.record().users;
  };
  takeAll(takeAll, kMany);
  EXPECT_LT(recordsOf(pool), static_cast<std::size_t>(kMany)) << "what is beyond is not kept";
  EXPECT_GE(recordsOf(pool), 64U);
}

TEST(WorkPool, OnManyThreadsNobodyHasAnothersRecord) {
  WorkPool<Work> pool;
  std::atomic<int> shared = 0;
  forEach(20000, [&](std::size_t i) {
    const auto taken = pool.take();
    if (++taken.record().users != 1) ++shared;
    taken.record().kept.assign(i % 7, 0);
    --taken.record().users;
  });
  EXPECT_EQ(shared, 0);
}

TEST(ReserveClosely, KeepsAnEighthToSpare) {
  std::vector<double> values;
  int moves = 0;
  for (std::size_t i = 0; i < 10000; ++i) {
    const std::size_t before = values.capacity();
    reserveClosely(values.size() + 1, values);
    values.push_back(0.0);
    moves += values.capacity() != before ? 1 : 0;
  }
  EXPECT_LE(values.capacity(), 10000U + 10000U / 8U + 9U);
  EXPECT_LT(moves, 80) << "1.125 to the 60th is 1000";
}

}  // namespace
}  // namespace springtower
