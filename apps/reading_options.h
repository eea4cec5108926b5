/// Options on how files of particles are read, the same for every command that reads them.
#pragma once

#include <CLI/CLI.hpp>

#include "meniscus/io.h"

namespace meniscus::apps {

/// Adds --positions, --columns, --raw, --where, --boundaries, --scale, --origin and --allow-outside.
void add_reading_options(CLI::App& command, ReadOptions& reading);

}  // namespace meniscus::apps
