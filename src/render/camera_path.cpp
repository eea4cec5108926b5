#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "meniscus/render.h"

namespace meniscus {
namespace {

using nlohmann::json;

/// Cubic Hermite between two keys; the tangents are those of Catmull and Rom, for keys at uneven places.
/// u in [0, 1]; before and after may be the keys themselves at the ends of the path.
template <class T>
T between(const CameraKey& before, const CameraKey& a, const CameraKey& b, const CameraKey& after, T CameraKey::*part,
          double u) {
  const double span = b.at - a.at;
  const auto slope = [&](const CameraKey& from, const CameraKey& to) {
    return (to.*part - from.*part) * static_cast<float>(span / (to.at - from.at));
  };
  const T leaving = slope(before, b), arriving = slope(a, after);
  const double u2 = u * u, u3 = u2 * u;
  return a.*part * static_cast<float>(2 * u3 - 3 * u2 + 1) + leaving * static_cast<float>(u3 - 2 * u2 + u) +
         b.*part * static_cast<float>(3 * u2 - 2 * u3) + arriving * static_cast<float>(u3 - u2);
}

[[noreturn]] void refuse(const std::string& path, std::string problem, std::string expected, std::string found) {
  throw Error(ErrorCode::malformed_file,
              {std::move(problem), std::move(expected), std::move(found), path, {}, {}, "correct the camera file"});
}

float number_in(const json& value, const std::string& path, const std::string& field) {
  if (!value.is_number()) refuse(path, field + " is not a number", "a number", value.dump().substr(0, 40));
  const double number = value.get<double>();
  if (!std::isfinite(static_cast<float>(number))) refuse(path, field + " is out of range", "a number", value.dump());
  return static_cast<float>(number);
}

vec3 vector_in(const json& key, const std::string& path, const std::string& where, const char* name) {
  const std::string field = where + "." + name;
  if (!key.contains(name)) refuse(path, field + " is missing", "[x, y, z] in metres", "nothing");
  const json& value = key[name];
  if (!value.is_array() || value.size() != 3)
    refuse(path, field + " is not a point", "[x, y, z] in metres", value.dump().substr(0, 40));
  return {number_in(value[0], path, field + "[0]"), number_in(value[1], path, field + "[1]"),
          number_in(value[2], path, field + "[2]")};
}

json parsed(const std::string& path) {
  std::ifstream file(path);
  if (!file) throw Error(ErrorCode::not_found, {"the camera file cannot be opened", {}, {}, path, {}, {}, {}});
  try {
    return json::parse(file);
  } catch (const json::parse_error& error) {
    throw Error(ErrorCode::malformed_file,
                {"this is not JSON", {}, {}, path, error.byte, {}, "correct the camera file"});
  }
}

}  // namespace

CameraPath::CameraPath(std::vector<CameraKey> keys, bool in_seconds) : keys_(std::move(keys)), in_seconds_(in_seconds) {
  if (keys_.empty()) throw Error(ErrorCode::invalid_argument, "a camera path needs at least one key");
  for (std::size_t i = 1; i < keys_.size(); ++i)
    if (!(keys_[i - 1].at < keys_[i].at))
      throw Error(ErrorCode::invalid_argument, fmt::format("the keys of a camera path must rise, but key {} is at {} "
                                                           "after {}",
                                                           i, keys_[i].at, keys_[i - 1].at));
}

CameraKey CameraPath::at(double place) const {
  if (!(place > keys_.front().at)) return keys_.front();
  if (place >= keys_.back().at) return keys_.back();
  const auto next = std::upper_bound(keys_.begin(), keys_.end(), place,
                                     [](double value, const CameraKey& key) { return value < key.at; });
  const CameraKey& b = *next;
  const CameraKey& a = *(next - 1);
  const CameraKey& before = next - 1 == keys_.begin() ? a : *(next - 2);
  const CameraKey& after = next + 1 == keys_.end() ? b : *(next + 1);
  const double u = (place - a.at) / (b.at - a.at);
  CameraKey key;
  key.at = place;
  key.eye = between(before, a, b, after, &CameraKey::eye, u);
  key.target = between(before, a, b, after, &CameraKey::target, u);
  key.fov_deg = std::clamp(between(before, a, b, after, &CameraKey::fov_deg, u), 0.01f, 179.0f);
  return key;
}

CameraPath read_camera_path(const std::string& path, float default_fov_deg) {
  const json file = parsed(path);
  if (!file.is_object() || !file.contains("keys") || !file["keys"].is_array() || file["keys"].empty())
    refuse(path, "keys is missing or empty", "{\"keys\": [{\"frame\": 0, \"eye\": [x, y, z], \"target\": [x, y, z]}]}",
           file.dump().substr(0, 40));
  std::vector<CameraKey> keys;
  bool in_seconds = false;
  for (const json& entry : file["keys"]) {
    const std::string where = fmt::format("keys[{}]", keys.size());
    if (!entry.is_object()) refuse(path, where + " is not an object", "{...}", entry.dump().substr(0, 40));
    const bool has_time = entry.contains("time");
    if (has_time == entry.contains("frame"))
      refuse(path, where + " needs either frame or time", "one of them", has_time ? "both" : "neither");
    if (keys.empty()) in_seconds = has_time;
    if (has_time != in_seconds)
      refuse(path, where + " counts otherwise than keys[0]", in_seconds ? "time" : "frame",
             has_time ? "time" : "frame");
    CameraKey key;
    const char* name = has_time ? "time" : "frame";
    key.at = number_in(entry[name], path, where + "." + name);
    if (!keys.empty() && !(key.at > keys.back().at))
      refuse(path, fmt::format("{}.{} does not rise", where, name), fmt::format("more than {}", keys.back().at),
             fmt::format("{}", key.at));
    key.eye = vector_in(entry, path, where, "eye");
    key.target = vector_in(entry, path, where, "target");
    if (key.eye == key.target) refuse(path, where + ".eye is where " + where + ".target is", "two points", "one");
    key.fov_deg = entry.contains("fov") ? number_in(entry["fov"], path, where + ".fov") : default_fov_deg;
    if (!(key.fov_deg > 0 && key.fov_deg < 180))
      refuse(path, where + ".fov is out of range", "0 to 180 degrees", fmt::format("{}", key.fov_deg));
    keys.push_back(key);
  }
  return {std::move(keys), in_seconds};
}

}  // namespace meniscus
