#include "bench_options.h"

#include <iostream>

namespace meniscus::apps {

void add_particles(CLI::App& command, std::size_t& particles, std::size_t least, std::size_t most,
                   const std::string& description) {
  command.add_option("--particles", particles, description)
      ->type_name("N")
      ->check(CLI::Range(least, most).description(""));
}

void add_size(CLI::App& command, const char* option, PictureSize& size, const std::string& description) {
  command
      .add_option_function<std::string>(
          option, [option, &size](const std::string& text) { size = parse_size(option, text); }, description)
      ->type_name("WIDTHxHEIGHT");
}

void add_seed(CLI::App& command, std::uint64_t& seed) {
  command.add_option("--seed", seed, "Of the particles' places (default: 1)")->type_name("N");
}

void add_repeat(CLI::App& command, int& repeats, const std::string& description) {
  command.add_option("--repeat", repeats, description)->type_name("N")->check(CLI::Range(1, 1000).description(""));
}

void add_threads(CLI::App& command, int& threads) {
  command.add_option("--threads", threads, "Threads; 0: one a core (default: 0)")
      ->type_name("N")
      ->check(CLI::Range(0, 1024).description(""));
}

void add_json(CLI::App& command, bool& json) { command.add_flag("--json", json, "Print one JSON object"); }

void print_json(const Json& json) { std::cout << text_of(json) << '\n'; }

}  // namespace meniscus::apps
