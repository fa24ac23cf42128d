#include "tests/apps/viewer/play/naive_player.h"

#include "core/version.h"

#include <algorithm>
#include <cstdlib>
#include <fmt/format.h>
#include <gtest/gtest.h>

namespace springtower {
namespace {

// SPRINGTOWER_NAIVE_GAMES: how many games, if not as given here (the target naive_games plays fifty and fifty).
int gamesOr(int usual) {
  const char* given = std::getenv("SPRINGTOWER_NAIVE_GAMES");
  return given == nullptr ? usual : std::atoi(given);
}

void playGames(std::uint64_t firstSeed, int count) {
  int good = 0;
  std::string faults;
  std::vector<double> frames_ms;
  std::uint64_t seed = firstSeed;
  for (int played = 0; played < count; ++seed) {
    const NaiveGame game = playNaively(seed);
    if (!game.hinted) continue;
    ++played;
    frames_ms.insert(frames_ms.end(), game.frames_ms.begin(), game.frames_ms.end());
    good += game.fault.empty() ? 1 : 0;
    EXPECT_LE(game.force_n, tuning::kGripForce_n * (1.0 + 1e-9));
    if (game.fault.empty()) continue;
    faults += fmt::format("seed {}, block {} of row {}: {}\n", game.seed, game.block, game.row, game.fault);
  }
  std::sort(frames_ms.begin(), frames_ms.end());
  const auto quantile = [&](double share) {
    return frames_ms[static_cast<std::size_t>(share * static_cast<double>(frames_ms.size() - 1))];
  };
  fmt::print("{} of {} games good; a frame takes {:.3f} ms in the median, {:.3f} ms at 99 %, {:.3f} ms at most\n{}", good, count,
             quantile(0.5), quantile(0.99), quantile(1.0), faults);
  EXPECT_GE(10 * good, 9 * count) << faults;
}

TEST(NaivePlayer, SucceedsInNineOfTenGamesOfFixedSeeds) {
  playGames(1, gamesOr(10));
}

TEST(NaivePlayer, SucceedsInNineOfTenGamesOfTheCommit) {
  std::uint64_t seed = 0;
  for (const char c : std::string_view(kGitCommit)) seed = 31 * seed + static_cast<unsigned char>(c);
  playGames(1000 + seed % 1000000, gamesOr(10));
}

}  // namespace
}  // namespace springtower
