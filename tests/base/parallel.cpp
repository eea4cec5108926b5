#include <gtest/gtest.h>

#include <atomic>
#include <mutex>
#include <set>
#include <thread>

#include "meniscus/base.h"

namespace meniscus {
namespace {

using Piece = std::pair<std::size_t, std::size_t>;

/// The pieces that parallel_for hands out, in order of their beginnings.
std::multiset<Piece> pieces_of(std::size_t count, std::size_t grain) {
  std::mutex mutex;
  std::multiset<Piece> pieces;
  parallel_for(count, grain, [&](std::size_t begin, std::size_t end) {
    const std::lock_guard lock(mutex);
    pieces.emplace(begin, end);
  });
  return pieces;
}

class EachThreadCount : public testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(ParallelFor, EachThreadCount, testing::Values(1, 2, 5), testing::PrintToStringParamName());

TEST_P(EachThreadCount, EveryIndexIsVisitedExactlyOnce) {
  const ThreadLimit limit(GetParam());
  for (const std::size_t count : {0u, 1u, 6u, 7u, 8u, 1000u, 1001u})
    for (const std::size_t grain : {1u, 7u, 1000u, 5000u}) {
      std::vector<std::atomic<int>> visits(count);
      parallel_for(count, grain, [&](std::size_t begin, std::size_t end) {
        ASSERT_LT(begin, end);
        ASSERT_LE(end, count);
        EXPECT_LE(end - begin, grain);
        for (std::size_t i = begin; i < end; ++i) ++visits[i];
      });
      for (std::size_t i = 0; i < count; ++i) ASSERT_EQ(visits[i], 1) << "index " << i << " of " << count;
    }
}

TEST_P(EachThreadCount, PiecesAreThoseOfOneThread) {
  std::multiset<Piece> of_one_thread;
  {
    const ThreadLimit one(1);
    of_one_thread = pieces_of(1003, 10);
  }
  EXPECT_EQ(of_one_thread.size(), 101u);
  const ThreadLimit limit(GetParam());
  EXPECT_EQ(pieces_of(1003, 10), of_one_thread);
}

TEST_P(EachThreadCount, NoMoreThreadsRunThanAllowed) {
  const ThreadLimit limit(GetParam());
  EXPECT_EQ(thread_count(), GetParam());
  std::atomic<int> running{0}, most{0};
  parallel_for(200, 1, [&](std::size_t, std::size_t) {
    const int now = ++running;
    int seen = most;
    while (now > seen && !most.compare_exchange_weak(seen, now)) {
    }
    std::this_thread::sleep_for(std::chrono::microseconds(50));
    --running;
  });
  EXPECT_LE(most, GetParam());
}

TEST_P(EachThreadCount, ExceptionsReachTheCaller) {
  const ThreadLimit limit(GetParam());
  const auto throw_at = [](std::size_t bad) {
    parallel_for(100, 1, [bad](std::size_t begin, std::size_t) {
      if (begin == bad) throw Error(ErrorCode::limit_exceeded, "piece " + std::to_string(bad));
    });
  };
  for (const std::size_t bad : {0u, 50u, 99u}) {
    try {
      throw_at(bad);
      ADD_FAILURE() << "nothing was thrown";
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::limit_exceeded);
      EXPECT_EQ(error.detail().problem, "piece " + std::to_string(bad));
    }
  }
  EXPECT_NO_THROW(throw_at(1000));
}

TEST_P(EachThreadCount, LoopsMayBeNested) {
  const ThreadLimit limit(GetParam());
  std::vector<std::atomic<int>> visits(30 * 40);
  parallel_for(30, 1, [&](std::size_t row, std::size_t) {
    parallel_for(40, 3, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) ++visits[row * 40 + i];
    });
  });
  for (const auto& visit : visits) ASSERT_EQ(visit, 1);
}

TEST(ParallelFor, AGrainOfZeroIsOne) {
  EXPECT_EQ(pieces_of(5, 0), (std::multiset<Piece>{{0, 1}, {1, 2}, {2, 3}, {3, 4}, {4, 5}}));
}

TEST(ThreadLimit, GivesBackWhatItTook) {
  const int before = thread_count();
  {
    const ThreadLimit outer(3);
    EXPECT_EQ(thread_count(), 3);
    {
      const ThreadLimit inner(1);
      EXPECT_EQ(thread_count(), 1);
    }
    EXPECT_EQ(thread_count(), 3);
  }
  EXPECT_EQ(thread_count(), before);
}

TEST(ThreadLimit, ALargerOneInsideOfASmallerOneLeavesItAndSaysNothing) {
  testing::internal::CaptureStderr();
  testing::internal::CaptureStdout();
  {
    const ThreadLimit outer(2);
    const ThreadLimit inner(7);
    EXPECT_EQ(thread_count(), 2);
    EXPECT_EQ(pieces_of(100, 3).size(), 34u);
  }
  {
    const ThreadLimit alone(7);
    EXPECT_EQ(thread_count(), 7);
    EXPECT_EQ(pieces_of(100, 3).size(), 34u);
  }
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
  EXPECT_EQ(testing::internal::GetCapturedStdout(), "");
}

}  // namespace
}  // namespace meniscus
