/// Options that the benches share, and what is done with their result.
#pragma once

#include <CLI/CLI.hpp>
#include <memory>
#include <string>

#include "json.h"
#include "parse.h"

namespace meniscus::apps {

void add_particles(CLI::App& command, std::size_t& particles, std::size_t least, std::size_t most,
                   const std::string& description);
/// "--size", "--screen": WIDTHxHEIGHT. `size` must stay where it is while the arguments are parsed.
void add_size(CLI::App& command, const char* option, PictureSize& size, const std::string& description);
void add_seed(CLI::App& command, std::uint64_t& seed);
void add_repeat(CLI::App& command, int& repeats, const std::string& description);
void add_threads(CLI::App& command, int& threads);
void add_json(CLI::App& command, bool& json);

/// One line.
void print_json(const Json& json);

/// Measures when the arguments have been parsed, and prints the result for machines or for people.
template <class Arguments>
void run_with(CLI::App& command, std::shared_ptr<Arguments> arguments, Json (*measure)(const Arguments&),
              void (*print)(const Json&)) {
  command.callback([arguments = std::move(arguments), measure, print] {
    const Json json = measure(*arguments);
    if (arguments->json)
      print_json(json);
    else
      print(json);
  });
}

}  // namespace meniscus::apps
