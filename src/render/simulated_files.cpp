/// Simulated frames as files, and the ways of their bodies.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fstream>

#include "meniscus/io.h"
#include "meniscus/render.h"

namespace meniscus {
namespace {

using Transforms = std::vector<std::optional<glm::mat4>>;

OutputTarget target_of(const std::string& output, std::size_t frames) {
  std::string ending = std::filesystem::path(output).extension().string();
  for (char& c : ending)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c + 32);
  if (ending != ".ply")
    throw Error(ErrorCode::invalid_argument, {"simulated frames are written as PLY files",
                                              "a name that ends with .ply",
                                              ending.empty() ? "no extension" : ending,
                                              output,
                                              {},
                                              {},
                                              "pictures and films of a simulation are drawn by meniscus render"});
  OutputTarget target(output);
  if (frames > 1 && !target.is_pattern())
    throw Error(ErrorCode::invalid_argument, {fmt::format("{} frames do not fit into one file", frames),
                                              "a pattern",
                                              {},
                                              target.path(),
                                              {},
                                              {},
                                              "write to a name with {} for the frame number"});
  target.prepare();
  return target;
}

/// Whether a file is as long as one that holds these particles; what was cut off is not.
bool is_whole(const std::string& path, const Particles& particles) {
  std::error_code error;
  const std::uintmax_t bytes = std::filesystem::file_size(path, error);
  if (error) return false;
  std::ifstream file(path, std::ios::binary);
  std::string head(4096, '\0');
  file.read(head.data(), static_cast<std::streamsize>(head.size()));
  head.resize(static_cast<std::size_t>(file.gcount()));
  const std::string last = "end_header\n";
  const std::size_t end = head.find(last);
  if (end == std::string::npos) return false;
  const std::size_t counted = head.find(fmt::format("\nelement vertex {}\n", particles.size()));
  std::size_t floats = 3;
  for (const Attribute& attribute : particles.attributes) floats += static_cast<std::size_t>(attribute.components);
  return counted < end && bytes == end + last.size() + 4 * floats * particles.size();
}

bool moves(const std::vector<Transforms>& frames, std::size_t body) {
  return std::any_of(frames.begin(), frames.end(), [&](const Transforms& transforms) {
    return !transforms[body] || *transforms[body] != glm::mat4(1.0f);
  });
}

std::string way_text(const std::vector<Transforms>& frames, std::size_t body) {
  std::string text = "[\n";
  for (std::size_t i = 0; i < frames.size(); ++i) {
    if (const std::optional<glm::mat4>& m = frames[i][body]) {
      text += "{\"matrix\": [";
      for (int row = 0; row < 3; ++row)
        text +=
            fmt::format("{}[{}, {}, {}, {}]", row ? ", " : "", (*m)[0][row], (*m)[1][row], (*m)[2][row], (*m)[3][row]);
      text += "]}";
    } else {
      text += "{\"present\": false}";
    }
    text += i + 1 < frames.size() ? ",\n" : "\n";
  }
  return text + "]\n";
}

/// A name that can be a part of a file's name on any system.
std::string file_name_of(const BodyOptions& body, std::size_t index) {
  std::string name = body.name.empty() ? fmt::format("body_{}", index) : body.name;
  for (char& c : name) {
    const bool plain = (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '-';
    if (!plain) c = '_';
  }
  return name;
}

}  // namespace

SimulationReport write_simulation(SimulatedScene& scene, std::span<const BodyOptions> bodies, const std::string& output,
                                  std::size_t frames, bool resume,
                                  FunctionRef<void(const SimulatedFrame&, std::size_t, std::size_t)>* on_frame) {
  frames = std::min(frames, scene.frames());
  const OutputTarget target = target_of(output, frames);
  SimulationReport report;
  std::vector<Transforms> transforms;
  std::size_t steps = 0;
  for (std::size_t i = 0; i < frames; ++i) {
    const auto start = std::chrono::steady_clock::now();
    SimulatedFrame frame;
    frame.output = target.path_of(static_cast<std::int64_t>(i));
    const Particles particles = scene.frame(i, &frame.times);
    transforms.push_back(scene.transforms());
    frame.particles = particles.size();
    frame.time = scene.simulation().time();
    frame.steps = scene.simulation().steps() - steps;
    steps = scene.simulation().steps();
    frame.mean_neighbours = scene.simulation().mean_neighbours();
    frame.kinetic_energy = scene.simulation().kinetic_energy();
    frame.skipped = resume && is_whole(frame.output, particles);
    if (!frame.skipped) {
      const StageTimer timer(&frame.times, "write");
      write_particles(frame.output, particles);
    }
    frame.frame_ms = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
    report.times.add(frame.times);
    report.frames.push_back(std::move(frame));
    if (on_frame) (*on_frame)(report.frames.back(), i, frames);
  }
  const std::filesystem::path folder = std::filesystem::path(output).parent_path();
  for (std::size_t body = 0; body < bodies.size(); ++body) {
    std::string& way = report.ways.emplace_back();
    if (!bodies[body].role || !moves(transforms, body)) continue;
    std::string name = file_name_of(bodies[body], body) + "_way.json";
    // Names that differ only in what a file's name cannot hold.
    if (std::find(report.ways.begin(), report.ways.end(), (folder / name).string()) != report.ways.end())
      name = fmt::format("body_{}_way.json", body);
    way = (folder / name).string();
    write_text(way, way_text(transforms, body));
  }
  return report;
}

}  // namespace meniscus
