#include <fmt/format.h>
#include <algorithm>
#include <cerrno>
#include <climits>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <map>
#include <mutex>

#include "scene/texture.h"

#define STBI_NO_STDIO
#define STBI_ONLY_PNG
#define STBI_ONLY_JPEG
#define STBI_ONLY_TGA
#define STBI_ONLY_BMP
#define STB_IMAGE_STATIC
#define STB_IMAGE_IMPLEMENTATION
#include <stb_image.h>

namespace meniscus {
namespace {

constexpr int kMaxEdge = 16384;
/// Deflate makes of a byte at most 1032; three or four of them are a pixel.
constexpr std::size_t kMaxPixelsPerByte = 1100;

constexpr const char* kAdvice = "give a PNG, JPEG, TGA or BMP picture";

/// stb_image fills the rest of a truncated JPEG with grey; a whole one has an end-of-image marker.
bool is_truncated_jpeg(std::span<const unsigned char> bytes) {
  if (bytes.size() < 3 || bytes[0] != 0xFF || bytes[1] != 0xD8) return false;
  for (std::size_t i = bytes.size() - 1; i > 2; --i)
    if (bytes[i - 1] == 0xFF && bytes[i] == 0xD9) return false;
  return true;
}

}  // namespace

std::shared_ptr<const Texture> decode_texture(std::span<const unsigned char> bytes, const std::string& path) {
  const auto fail = [&](ErrorCode code, std::string problem, std::string expected = {}, std::string found = {}) {
    throw Error(code, {std::move(problem), std::move(expected), std::move(found), path, {}, {}, kAdvice});
  };
  if (bytes.size() > INT_MAX) fail(ErrorCode::limit_exceeded, "the texture's file is larger than 2 GiB");
  const int size = static_cast<int>(bytes.size());
  int width = 0, height = 0, channels = 0;
  if (!stbi_info_from_memory(bytes.data(), size, &width, &height, &channels))
    fail(ErrorCode::malformed_file, "this is not a picture that can be read as a texture", "PNG, JPEG, TGA or BMP",
         stbi_failure_reason() ? stbi_failure_reason() : "");
  if (width < 1 || height < 1 || width > kMaxEdge || height > kMaxEdge)
    fail(ErrorCode::limit_exceeded, "the texture is too large", fmt::format("at most {0} x {0} pixels", kMaxEdge),
         fmt::format("{} x {}", width, height));
  const std::size_t pixels = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  if (pixels > bytes.size() * kMaxPixelsPerByte)
    fail(ErrorCode::malformed_file, "the file is too short for its picture", fmt::format("{} pixels", pixels),
         fmt::format("{} bytes", bytes.size()));
  if (is_truncated_jpeg(bytes)) fail(ErrorCode::malformed_file, "the picture's file ends too early");
  const std::unique_ptr<stbi_uc, void (*)(void*)> decoded(
      stbi_load_from_memory(bytes.data(), size, &width, &height, &channels, 3), stbi_image_free);
  if (!decoded)
    fail(ErrorCode::malformed_file, "the texture is damaged", {}, stbi_failure_reason() ? stbi_failure_reason() : "");
  Image<Texel> picture(width, height);
  for (std::size_t i = 0; i < picture.size(); ++i)
    picture[i] = {decoded.get()[3 * i], decoded.get()[3 * i + 1], decoded.get()[3 * i + 2]};
  return std::make_shared<const Texture>(std::move(picture));
}

std::shared_ptr<const Texture> read_texture(const std::string& path) {
  std::error_code status;
  if (!std::filesystem::exists(path, status))
    throw Error(ErrorCode::not_found, {"there is no such texture", {}, {}, path, {}, {}, kAdvice});
  std::ifstream file(path, std::ios::binary | std::ios::ate);
  if (!file || std::filesystem::is_directory(path, status))
    throw Error(ErrorCode::io_failed, {"the texture cannot be read", {}, std::strerror(errno), path, {}, {}, {}});

  // A file that was written anew since is another texture.
  static std::mutex mutex;
  static std::map<std::string, std::weak_ptr<const Texture>> kept;
  const auto written = std::filesystem::last_write_time(path, status).time_since_epoch().count();
  const std::string key = fmt::format("{}\n{}\n{}", path, written, static_cast<long long>(file.tellg()));
  const std::lock_guard lock(mutex);
  if (auto texture = kept[key].lock()) return texture;

  std::vector<unsigned char> bytes(static_cast<std::size_t>(file.tellg()));
  file.seekg(0);
  file.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  if (!file) throw Error(ErrorCode::io_failed, {"reading the texture failed", {}, {}, path, {}, {}, {}});
  auto texture = decode_texture(bytes, path);
  std::erase_if(kept, [](const auto& entry) { return entry.second.expired(); });
  kept[key] = texture;
  return texture;
}

}  // namespace meniscus
