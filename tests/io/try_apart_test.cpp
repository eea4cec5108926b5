// Work that stops a copy of the program does not stop the program.
#include "io/try_apart.h"

#include <gtest/gtest.h>

#include <csignal>
#include <cstdlib>
#include <stdexcept>

namespace meniscus::io {
namespace {

int asked = 0;

TEST(TryApart, SaysNothingOfWorkThatComesToItsEnd) {
  EXPECT_EQ(what_stops([](std::string_view) { asked = 1; }, "", 10), std::nullopt);
  EXPECT_EQ(asked, 0);  // it was a copy's
  EXPECT_EQ(what_stops([](std::string_view) { throw std::runtime_error("met again by who does it again"); }, "", 10),
            std::nullopt);
}

TEST(TryApart, HandsOverTheRequestAsItIs) {
  const auto judge = [](std::string_view request) {
    if (request.size() == 100'000 && request[99'999] == '\0') std::_Exit(7);
  };
  EXPECT_EQ(what_stops(judge, std::string(100'000, '\0'), 10), "exit code 7");
  EXPECT_EQ(what_stops(judge, std::string(100'000, 'x'), 10), std::nullopt);
}

TEST(TryApart, SaysWhatStoppedTheWork) {
  const std::optional<std::string> killed = what_stops([](std::string_view) { std::raise(SIGTERM); }, "", 10);
  ASSERT_TRUE(killed);
  EXPECT_NE(killed->find("signal 15"), std::string::npos) << *killed;
  EXPECT_TRUE(what_stops([](std::string_view) { std::abort(); }, "", 10));
  EXPECT_EQ(what_stops([](std::string_view) { std::_Exit(3); }, "", 10), "exit code 3");
}

TEST(TryApart, StopsWorkWithoutEnd) {
  const auto endless = [](std::string_view) {
    volatile bool on = true;
    while (on) {
    }
  };
  const std::optional<std::string> late = what_stops(endless, "", 1);
  ASSERT_TRUE(late);
  EXPECT_NE(late->find("more than 1 s"), std::string::npos) << *late;
}

}  // namespace
}  // namespace meniscus::io
