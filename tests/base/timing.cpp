#include <gtest/gtest.h>

#include <chrono>
#include <memory>
#include <thread>

#include "meniscus/base.h"

namespace meniscus {
namespace {

using Rows = std::vector<std::pair<std::string, double>>;

TEST(StageTimes, RowsOfTheSameNameAddUpInOrderOfFirstUse) {
  StageTimes times;
  EXPECT_EQ(times.total_ms(), 0.0);
  times.add("march", 2);
  times.add("sort", 1);
  times.add("march", 3);
  EXPECT_EQ(times.rows(), (Rows{{"march", 5}, {"sort", 1}}));
  EXPECT_EQ(times.total_ms(), 6.0);
}

TEST(StageTimes, TablesAddRowByRow) {
  StageTimes frame, film;
  film.add("sort", 10);
  frame.add("shade", 4);
  frame.add("sort", 1);
  film.add(frame);
  film.add(frame);
  EXPECT_EQ(film.rows(), (Rows{{"sort", 12}, {"shade", 8}}));
}

TEST(StageTimer, AddsItsLifetimeToItsRow) {
  StageTimes times;
  for (int i = 0; i < 2; ++i) {
    const StageTimer timer(&times, "sleep");
    EXPECT_EQ(times.rows().size(), i == 0 ? 0u : 1u);  // added at the end, not before
    std::this_thread::sleep_for(std::chrono::milliseconds(3));
  }
  ASSERT_EQ(times.rows().size(), 1u);
  EXPECT_EQ(times.rows()[0].first, "sleep");
  EXPECT_GE(times.rows()[0].second, 6.0);  // a sleep is never shorter than asked for
}

TEST(StageTimer, MeasuresNothingWithoutATable) { EXPECT_NO_THROW(StageTimer(nullptr, "nothing")); }

TEST(PeakRss, CountsWhatWasTouchedEvenAfterItIsFreed) {
  constexpr std::uint64_t kTouched = std::uint64_t{1} << 28;  // beyond what a test program needs by itself
  {
    const std::unique_ptr<char[]> bytes(new char[kTouched]);
    volatile char* touched = bytes.get();  // a compiler may leave out an array that nobody looks at
    for (std::uint64_t i = 0; i < kTouched; i += 1024) touched[i] = 1;
  }
  EXPECT_GE(peak_rss_bytes(), kTouched);
  EXPECT_LT(peak_rss_bytes(), 64 * kTouched);  // bytes, not something smaller
}

}  // namespace
}  // namespace meniscus
