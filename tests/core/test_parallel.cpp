#include <atomic>
#include <vector>

#include <gtest/gtest.h>

#include "normalshop/core/error.h"
#include "normalshop/core/parallel.h"
#include "normalshop/core/progress.h"

namespace normalshop {
namespace {

TEST(ParallelFor, CoversTheRangeOnce) {
  std::vector<std::atomic<int>> visits(1000);
  parallel_for(visits.size(), 7, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) ++visits[i];
  });
  for (const auto& count : visits) EXPECT_EQ(count.load(), 1);
}

TEST(ParallelFor, DoesNothingForNothing) {
  parallel_for(0, 1, [](std::size_t, std::size_t) { FAIL(); });
}

TEST(ParallelFor, RethrowsWhatTheBodyThrows) {
  const auto body = [](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      if (i == 777) throw InvalidInput("item 777");
    }
  };
  EXPECT_THROW(parallel_for(1000, 1, body), InvalidInput);
  EXPECT_THROW(parallel_for(1000, 1000, body), InvalidInput);
}

TEST(ThreadLimit, HoldsWhileItLives) {
  const int before = thread_count();
  {
    const ThreadLimit limit(1);
    EXPECT_EQ(thread_count(), 1);
  }
  EXPECT_EQ(thread_count(), before);
}

TEST(Progress, CancelsWhenItsReceiverSaysSo) {
  EXPECT_NO_THROW(Progress{}.at(0.5, "stage"));
  const Progress stop{[](double, std::string_view) { return false; }};
  EXPECT_THROW(stop.at(0.5, "stage"), Cancelled);
}

}  // namespace
}  // namespace normalshop
