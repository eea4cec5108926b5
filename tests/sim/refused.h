/// That a call is refused with an error of the right kind.
#pragma once

#include <gtest/gtest.h>

#include <functional>

#include "meniscus/base.h"

namespace meniscus {

inline void expect_refused(const std::function<void()>& call, ErrorCode code = ErrorCode::invalid_argument) {
  try {
    call();
    FAIL() << "not refused";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), code) << error.what();
  }
}

}  // namespace meniscus
