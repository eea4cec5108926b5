/// Text out of files, fit to be shown: valid UTF-8 without control characters.
#pragma once

#include <string>

#include "meniscus/base.h"

namespace meniscus::io {

/// Puts '?' for each byte that is no UTF-8, and for control characters.
void make_readable(std::string& text);

/// The error with readable texts. Its path is as it was: it must name the file.
Error readable(const Error& error);

}  // namespace meniscus::io
