// Work that stops a copy of the program does not stop the program.
#include "io/try_apart.h"

#include <gtest/gtest.h>

#include <csignal>
#include <cstdlib>
#include <stdexcept>

namespace meniscus::io {
namespace {

TEST(TryApart, SaysNothingOfWorkThatComesToItsEnd) {
  int here = 0;
  EXPECT_EQ(what_stops([&] { here = 1; }, 10), std::nullopt);
  EXPECT_EQ(here, 0);  // it was a copy's
  EXPECT_EQ(what_stops([] { throw std::runtime_error("met again by who does it again"); }, 10), std::nullopt);
}

TEST(TryApart, SaysWhatStoppedTheWork) {
  const std::optional<std::string> killed = what_stops([] { std::raise(SIGTERM); }, 10);
  ASSERT_TRUE(killed);
  EXPECT_NE(killed->find("signal 15"), std::string::npos) << *killed;
  EXPECT_TRUE(what_stops([] { std::abort(); }, 10));
  EXPECT_EQ(what_stops([] { std::_Exit(3); }, 10), "exit code 3");
}

TEST(TryApart, StopsWorkWithoutEnd) {
  volatile bool on = true;
  const std::optional<std::string> late = what_stops(
      [&] {
        while (on) {
        }
      },
      1);
  ASSERT_TRUE(late);
  EXPECT_NE(late->find("more than 1 s"), std::string::npos) << *late;
}

}  // namespace
}  // namespace meniscus::io
