#include "estimate_text.h"

#include <fmt/format.h>

#include <cmath>

#include "progress.h"

namespace meniscus::apps {
namespace {

std::string bytes_text(std::uint64_t bytes) {
  const double b = static_cast<double>(bytes);
  if (b >= 1e9) return fmt::format("{:.2f} GB", b / 1e9);
  return b >= 1e6 ? fmt::format("{:.1f} MB", b / 1e6) : fmt::format("{:.0f} kB", b / 1e3);
}

/// Seconds to two digits, minutes and hours by the clock.
std::string time_text(double seconds) { return seconds < 60 ? fmt::format("{:.2g} s", seconds) : clock_text(seconds); }

/// Seconds to the millisecond.
double rounded(double seconds) { return std::round(seconds * 1000) / 1000; }

}  // namespace

std::string estimate_text(const RunEstimate& run, const std::string& output) {
  const RunMemory& memory = run.memory;
  std::string text = fmt::format("{} picture{} into {}, about {}\n", run.pictures, run.pictures == 1 ? "" : "s", output,
                                 bytes_text(run.output_bytes));
  text += fmt::format("  particles  {}{} in the largest frame, {} in all; {} to read\n", run.counted ? "" : "about ",
                      run.particles, run.all_particles, bytes_text(run.input_bytes));
  text += fmt::format("  memory     about {}: program {}, reading {}, particles {}, surface {}, pictures {}\n",
                      bytes_text(memory.peak), bytes_text(memory.program), bytes_text(memory.reading),
                      bytes_text(memory.particles), bytes_text(memory.surface), bytes_text(memory.picture));
  if (run.slabs > 1)
    text += fmt::format("             the water is drawn in about {} parts to keep to the limit\n", run.slabs);
  text += fmt::format("  time       about {} a picture, {} to look at the frames before: {}\n", time_text(run.frame_s),
                      time_text(run.survey_s), time_text(run.total_s));
  for (const std::string& note : run.notes) text += "  note       " + note + "\n";
  return text;
}

Json json_of(const RunEstimate& run) {
  const RunMemory& memory = run.memory;
  Json json;
  json["pictures"] = run.pictures;
  json["particles"] = run.particles;
  json["all_particles"] = run.all_particles;
  json["counted"] = run.counted;
  json["input_bytes"] = run.input_bytes;
  json["output_bytes"] = run.output_bytes;
  json["memory_bytes"] = {{"program", memory.program}, {"reading", memory.reading}, {"particles", memory.particles},
                          {"surface", memory.surface}, {"picture", memory.picture}, {"peak", memory.peak}};
  json["slabs"] = run.slabs;
  json["survey_s"] = rounded(run.survey_s);
  json["frame_s"] = rounded(run.frame_s);
  json["total_s"] = rounded(run.total_s);
  json["notes"] = run.notes;
  return json;
}

}  // namespace meniscus::apps
