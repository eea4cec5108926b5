#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <atomic>
#include <csignal>
#include <iostream>
#include <memory>

#include "commands.h"
#include "estimate_text.h"
#include "freed_memory.h"
#include "json.h"
#include "meniscus/render.h"
#include "picture_options.h"
#include "progress.h"

namespace meniscus::apps {
namespace {

struct RenderArguments {
  InputOptions input;
  PictureArguments picture;
  SequenceOptions sequence;
  std::string report_path;
  std::string output;  ///< empty: what the scene file says
  std::optional<double> frames_per_second;
  std::optional<int> quality_crf;
  bool quiet = false;
  int threads = 0;
  std::uint64_t memory_limit = 0;  ///< bytes; 0: none
  bool dry_run = false, json = false;
  bool follow = false;
  std::optional<double> follow_end;  ///< s
};

/// "depth,coverage"
std::vector<std::string> parse_layers(std::string_view text) {
  const std::vector<std::string> known = layer_names();
  std::vector<std::string> layers;
  while (true) {
    const std::size_t comma = text.find(',');
    layers.emplace_back(text.substr(0, comma));
    if (std::find(known.begin(), known.end(), layers.back()) == known.end())
      throw UsageError(fmt::format("--layers: {} was expected, not '{}'", fmt::join(known, ", "), layers.back()));
    if (comma == std::string_view::npos) return layers;
    text.remove_prefix(comma + 1);
  }
}

/// N pictures of one frame, if the camera moves.
std::size_t turntable_of(const RenderArguments& arguments, const PictureOptions& picture) {
  const bool moves = picture.camera.orbit_deg != 0 || picture.path;
  return moves && arguments.input.selection.first_n ? static_cast<std::size_t>(*arguments.input.selection.first_n) : 0;
}

/// What a scene file says, as far as the arguments do not say otherwise.
SceneFile scene_of(RenderArguments& arguments) {
  SceneFile scene;
  const std::optional<std::string> path = arguments.input.scene_file();
  if (path) scene = read_scene_file(*path);
  if (path && scene.frames.empty() && !scene.waves && !scene.simulation && !scene.heights && !scene.picture.rain)
    throw Error(ErrorCode::not_found, {"the scene file names no water",
                                       "\"water\": {\"frames\": ...}, or waves, heights or simulation; or rain",
                                       {},
                                       *path,
                                       {},
                                       {},
                                       {}});
  SequenceOptions& sequence = arguments.sequence;
  sequence.output = arguments.output.empty() ? scene.output : arguments.output;
  if (sequence.output.empty()) throw UsageError("--output is needed: where the picture goes");
  if (arguments.frames_per_second) scene.video.frames_per_second = *arguments.frames_per_second;
  if (arguments.quality_crf) scene.video.quality_crf = *arguments.quality_crf;
  sequence.video = scene.video;
  if (path) arguments.input.take(scene);
  return scene;
}

/// Refuses what cannot be meant together.
void check_together(const PictureOptions& picture) {
  if (picture.heights && picture.method != SurfaceMethod::height_field)
    throw UsageError("--surface: the scene's water.heights is a height field, and no particles are there");
  if (picture.optics.refraction == RefractionMethod::virtual_eye && picture.camera.orthographic_height && !picture.path)
    throw UsageError("--orthographic: virtual eyes (--refraction virtual_eye) need a perspective camera");
}

/// The first interrupt ends the following: the frame in work is finished, and the film. The second one ends all.
std::atomic<bool> following_ended{false};
extern "C" void end_following(int number) {
  following_ended = true;
  std::signal(number, SIG_DFL);
}

FrameFollower follower_of(const RenderArguments& arguments) {
  if (arguments.input.what.empty()) throw UsageError("--follow: there are no files to follow in this scene");
  if (arguments.input.selection.first_n || arguments.input.selection.begin || arguments.input.selection.end)
    throw UsageError("--follow and --frames cannot be meant together");
  if (arguments.memory_limit > 0 || arguments.dry_run)
    throw UsageError("--follow: what a run will take is not known beforehand: leave out --memory-limit and --dry-run");
  FrameFollower::Options options;
  options.end_after = arguments.follow_end;
  options.stopped = [] { return following_ended.load(); };
  for (const int number : {SIGINT, SIGTERM}) std::signal(number, end_following);
  return {arguments.input.what, arguments.input.reading, options};
}

void render(RenderArguments& arguments) {
  // All that can be wrong with the arguments shows before the work.
  const SceneFile scene = scene_of(arguments);
  static_cast<void>(OutputTarget(arguments.sequence.output));
  PictureOptions picture = arguments.picture.options(arguments.input, scene.picture);
  check_together(picture);
  if (!picture.material.empty()) static_cast<void>(material_preset(picture.material, 1.0f));
  if (!picture.environment_hdr.empty()) {
    EnvironmentOptions environment;
    environment.hdr_path = picture.environment_hdr;
    static_cast<void>(Environment(environment));
  }
  if (OutputTarget(arguments.sequence.output).format() == PictureFormat::ply &&
      picture.method != SurfaceMethod::surfels)
    throw UsageError("a .ply file holds surfels: add --surface surfels, or write a .png, .exr or .mp4");
  if (arguments.follow_end) arguments.follow = true;
  std::optional<FrameFollower> follower;
  if (arguments.follow) follower.emplace(follower_of(arguments));
  if (follower && !arguments.quiet) std::cerr << "meniscus: waiting for frames; an interrupt ends the film\n";
  const FrameSequence sequence = follower ? follower->first() : arguments.input.find_in(scene, arguments.quiet);
  if (follower) {
    arguments.sequence.further = [&] { return follower->further(); };
    arguments.sequence.read_again = [&](const FramePath& frame) { return follower->wait_for_change(frame); };
  }
  arguments.sequence.strict = arguments.input.strict;
  arguments.sequence.turntable = turntable_of(arguments, picture);
  const std::uint64_t made_particles = scene.waves ? scene.waves->particles : 0;
  const ThreadLimit limit(arguments.threads);
  picture.memory_limit = arguments.memory_limit;
  if (arguments.json && !arguments.dry_run) throw UsageError("--json is what --dry-run prints: give both, or --report");
  if (arguments.dry_run) {
    check_output_name(sequence, arguments.sequence);
    const RunEstimate run = estimate_run(sequence, picture, arguments.sequence, made_particles);
    std::cout << (arguments.json ? text_of(json_of(run), 2) + "\n" : estimate_text(run, arguments.sequence.output));
    check_memory(sequence, picture, arguments.sequence, made_particles);
    return;
  }
  check_memory(sequence, picture, arguments.sequence, made_particles);
  check_output(sequence, arguments.sequence);
  if (arguments.memory_limit == 0) keep_freed_memory();
  hold_memory_below(arguments.memory_limit);
  if (!arguments.report_path.empty()) write_text(arguments.report_path, "{}\n");

  Progress progress(arguments.quiet);
  SurveyOptions survey_options = arguments.input.survey_options();
  survey_options.colour = picture.colour;
  survey_options.sizes = picture.sizes;
  auto on_surveyed = [&](std::size_t done, std::size_t count) { progress.surveyed(done, count); };
  FunctionRef<void(std::size_t, std::size_t)> surveyed(on_surveyed);
  const Survey survey = survey_frames(sequence, survey_options, &surveyed);
  if (!arguments.quiet)
    for (const std::string& note : survey.notes) std::cerr << "meniscus: " << note << '\n';

  auto on_drawn = [&](const FrameReport& frame, std::size_t index, std::size_t count) {
    progress.drawn(frame, index, count);
  };
  FunctionRef<void(const FrameReport&, std::size_t, std::size_t)> drawn(on_drawn);
  const SequenceReport report = render_sequence(sequence, survey, picture, arguments.sequence, &drawn);
  progress.finish();

  if (!arguments.report_path.empty()) write_text(arguments.report_path, text_of(json_of(report), 2) + "\n");
  if (!arguments.quiet) {
    if (report.drawn > 0) std::cout << timing_table(report);
    std::cout << fmt::format("{} drawn, {} there already, {} left out: {}\n", report.drawn, report.skipped,
                             report.failed, arguments.sequence.output);
  }
  if (report.failed > 0) throw CLI::RuntimeError(kFailed);
}

void add_output(CLI::App& command, RenderArguments& arguments) {
  const char* group = "Output";
  SequenceOptions& sequence = arguments.sequence;
  command
      .add_option(
          "-o,--output", arguments.output,
          "A .png, .exr or .mp4 file, or a pattern with {} or {:04} for the frame number; with --surface surfels "
          "also a .ply of the surfels (default: what the scene file says)")
      ->type_name("FILE")
      ->group(group);
  command.add_option("--fps", arguments.frames_per_second, "Frames a second of a film, 0.1 to 1000 (default: 25)")
      ->type_name("N")
      ->check(CLI::Range(0.1, 1000.0).description(""))
      ->group(group);
  command.add_option("--quality", arguments.quality_crf, "Of a film: 0 lossless to 51 worst (default: 18)")
      ->type_name("CRF")
      ->check(CLI::Range(0, 51).description(""))
      ->group(group);
  command
      .add_flag("--follow", arguments.follow,
                "Draw frames as a running simulation writes them, until interrupted: the film is finished then. The "
                "camera is fitted to the frames that are there at the start")
      ->group(group);
  command.add_option("--follow-end", arguments.follow_end, "The same, until no new frame has come for so long")
      ->type_name("SECONDS")
      ->check(CLI::Range(0.0, 1e9).description(""))
      ->group(group);
  command.add_flag("--resume", sequence.resume, "Leave pictures and films that are there already as they are")
      ->group(group);
  command
      .add_option_function<std::string>(
          "--layers", [&sequence](const std::string& text) { sequence.layers = parse_layers(text); },
          "Layers of an EXR file: radiance, depth, normal, thickness, coverage, colour (default: all)")
      ->type_name("NAME,...")
      ->group(group);
  command.add_option("--report", arguments.report_path, "Write times and memory of every frame into a JSON file")
      ->type_name("FILE.json")
      ->group(group);
  command.add_flag("--quiet", arguments.quiet, "Say nothing but errors")->group(group);
  command.add_option("--threads", arguments.threads, "Threads, 0 to 1024; 0: one a core (default: 0)")
      ->type_name("N")
      ->check(CLI::Range(0, 1024).description(""))
      ->group(group);
  command
      .add_option_function<std::string>(
          "--instruction-set", [](const std::string& name) { use_instruction_set(name); },
          "Vector instructions to use, such as avx3, avx2, sse4 or best (default: best); the picture is the same")
      ->type_name("NAME")
      ->group(group);
  command
      .add_option_function<std::string>(
          "--memory-limit",
          [&arguments](const std::string& text) { arguments.memory_limit = parse_bytes("--memory-limit", text); },
          "Keep to this much memory, such as 4GB or 512MiB, or say before the start that it is not enough; water that "
          "does not fit as a whole is drawn in parts, where --refraction and --no-caustics allow it (default: 0, no "
          "limit)")
      ->type_name("SIZE")
      ->group(group);
  command
      .add_flag("--dry-run", arguments.dry_run,
                "Print what the run would take in memory, time and disk, and do nothing")
      ->group(group);
  command.add_flag("--json", arguments.json, "With --dry-run: print one JSON object")->group(group);
}

/// Runs, and tells of a limit that was met all the same.
void render_within(RenderArguments& arguments) {
  try {
    render(arguments);
  } catch (const std::bad_alloc&) {
    if (arguments.memory_limit == 0) throw;
    throw Error(ErrorCode::limit_exceeded, {"the run needs more memory than it may use",
                                            {},
                                            {},
                                            {},
                                            {},
                                            {},
                                            "raise --memory-limit, or make the picture smaller"});
  }
}

}  // namespace

void add_render(CLI::App& program) {
  CLI::App* command = program.add_subcommand("render", "Draw pictures or a film of the water");
  const auto arguments = std::make_shared<RenderArguments>();
  arguments->input.add_to(*command);
  arguments->picture.add_to(*command);
  add_output(*command, *arguments);
  command->footer(
      "Examples:\n"
      "  meniscus render frames/ -o film.mp4\n"
      "  meniscus render 'sim_*.vtk' -o pictures/{:04}.png --size 1920x1080 --resume\n"
      "  meniscus render frame_100.bgeo -o turn.mp4 --orbit 360 --frames 120\n"
      "  meniscus render frames/ -o film.mp4 --color-by velocity --range 0:3 --legend\n"
      "  meniscus render frames/ -o still.png --tank glass --mesh rock.obj --refraction ray_traced\n"
      "  meniscus render examples/pool.json -o pool.png");
  command->callback([arguments] { render_within(*arguments); });
}

}  // namespace meniscus::apps
