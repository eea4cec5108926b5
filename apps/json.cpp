#include "json.h"

#include <fmt/format.h>

#include <cmath>
#include <cstdlib>

namespace meniscus::apps {

Json json_of(float value) {
  if (!std::isfinite(value)) return nullptr;
  return std::strtod(fmt::format("{}", value).c_str(), nullptr);
}

Json json_of(vec3 point) { return Json::array({json_of(point.x), json_of(point.y), json_of(point.z)}); }

Json json_of(const StageTimes& times) {
  Json json = Json::object();
  for (const auto& [stage, ms] : times.rows()) json[stage] = std::round(ms * 1000) / 1000;
  return json;
}

Json json_of(const SequenceReport& report) {
  Json frames = Json::array();
  for (const FrameReport& frame : report.frames) {
    Json json;
    json["path"] = frame.path;
    json["output"] = frame.output;
    json["particles"] = frame.particles;
    json["width"] = frame.width;
    json["height"] = frame.height;
    json["stages_ms"] = json_of(frame.times);
    json["frame_ms"] = std::round(frame.frame_ms * 1000) / 1000;
    if (frame.skipped) json["skipped"] = true;
    if (!frame.problem.empty()) json["problem"] = frame.problem;
    if (!frame.notes.empty()) json["notes"] = frame.notes;
    frames.push_back(std::move(json));
  }
  Json json;
  json["frames"] = std::move(frames);
  json["drawn"] = report.drawn;
  json["skipped"] = report.skipped;
  json["failed"] = report.failed;
  json["peak_rss_bytes"] = peak_rss_bytes();
  return json;
}

std::string text_of(const Json& json, int indent) {
  return json.dump(indent, ' ', false, Json::error_handler_t::replace);
}

}  // namespace meniscus::apps
