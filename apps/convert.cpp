#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <iostream>
#include <memory>

#include "commands.h"
#include "input_options.h"
#include "meniscus/render.h"
#include "render/numbered_path.h"

namespace meniscus::apps {
namespace {

struct ConvertArguments {
  InputOptions input;
  std::string output;
  bool quiet = false;
  int threads = 0;
};

/// Where each frame goes.
std::vector<std::string> targets_of(const FrameSequence& sequence, const std::string& output) {
  const NumberedPath pattern(output);
  if (!pattern.understood()) throw UsageError("--output: {} or {:04} was expected for the frame's number in " + output);
  if (!pattern.is_numbered() && sequence.frames.size() > 1)
    throw UsageError(
        fmt::format("--output: {} frames do not fit into one file: give a name with {{}}", sequence.frames.size()));
  std::vector<std::string> targets;
  for (const std::int64_t number : picture_numbers(sequence)) targets.push_back(pattern.of(number));
  return targets;
}

void convert(const ConvertArguments& arguments) {
  const ThreadLimit limit(arguments.threads);
  FrameSequence sequence = arguments.input.find(arguments.quiet);
  const std::vector<std::string> targets = targets_of(sequence, arguments.output);
  std::size_t written = 0, failed = 0;
  for (std::size_t i = 0; i < targets.size(); ++i) {
    const FramePath& frame = sequence.frames[i];
    std::error_code ignored;
    const auto is_target = [&](const std::string& path) {
      return std::filesystem::equivalent(path, targets[i], ignored);
    };
    if (is_target(frame.path) || std::any_of(frame.further.begin(), frame.further.end(), is_target))
      throw UsageError(targets[i] + " would be written over itself: give another name");
    Particles particles;
    try {
      particles = read_frame(sequence, frame);
    } catch (const Error& error) {
      if (arguments.input.strict || targets.size() == 1 || error.code() == ErrorCode::invalid_argument) throw;
      std::cerr << "meniscus: left out: " << error.what() << '\n';
      ++failed;
      continue;
    }
    if (const auto parent = std::filesystem::path(targets[i]).parent_path(); !parent.empty())
      std::filesystem::create_directories(parent, ignored);
    write_particles(targets[i], particles);
    ++written;
    if (arguments.quiet) continue;
    for (const std::string& note : particles.notes) std::cerr << "meniscus: " << frame.path << ": " << note << '\n';
    std::cerr << fmt::format("{}/{} {} -> {} ({} particles)\n", i + 1, targets.size(), frame.path, targets[i],
                             particles.size());
  }
  if (!arguments.quiet) std::cout << fmt::format("{} written, {} left out\n", written, failed);
  if (failed > 0) throw CLI::RuntimeError(kFailed);
}

}  // namespace

void add_convert(CLI::App& program) {
  CLI::App* command = program.add_subcommand("convert", "Write frames of particles in another format");
  const auto arguments = std::make_shared<ConvertArguments>();
  arguments->input.add_to(*command);
  command
      ->add_option("-o,--output", arguments->output,
                   "A .vtp, .ply, .npz, .bgeo or .csv file, or a pattern with {} or {:04} for the frame's number")
      ->required()
      ->type_name("FILE");
  command->add_flag("--quiet", arguments->quiet, "Say nothing but errors");
  command->add_option("--threads", arguments->threads, "Threads, 0 to 1024; 0: one a core (default: 0)")
      ->type_name("N")
      ->check(CLI::Range(0, 1024).description(""));
  command->footer(
      "Examples:\n"
      "  meniscus convert frames/ -o vtp/{:04}.vtp\n"
      "  meniscus convert snapshot.hdf5 -o water.npz --positions /PartType0/Coordinates\n"
      "Frames that cannot be read are left out; the exit code is 1 then.");
  command->callback([arguments] { convert(*arguments); });
}

}  // namespace meniscus::apps
