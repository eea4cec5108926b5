/// Picture files made by tests.
#pragma once

#include <zlib.h>
#include <string>

#include "scene/texture.h"

namespace meniscus::tests {

inline void put_big(std::string& bytes, std::uint32_t value) {
  for (int shift = 24; shift >= 0; shift -= 8) bytes.push_back(static_cast<char>(value >> shift));
}

/// A PNG of 8-bit RGB, unfiltered.
inline std::string png_bytes(const Image<Texel>& picture) {
  std::string raw;
  for (int y = 0; y < picture.height(); ++y) {
    raw.push_back(0);
    for (int x = 0; x < picture.width(); ++x)
      for (const std::uint8_t value : {picture(x, y).r, picture(x, y).g, picture(x, y).b})
        raw.push_back(static_cast<char>(value));
  }
  uLongf size = compressBound(static_cast<uLong>(raw.size()));
  std::string packed(size, '\0');
  compress(reinterpret_cast<Bytef*>(packed.data()), &size, reinterpret_cast<const Bytef*>(raw.data()),
           static_cast<uLong>(raw.size()));
  packed.resize(size);

  std::string bytes = "\x89PNG\r\n\x1A\n";
  const auto chunk = [&](const std::string& kind, const std::string& body) {
    put_big(bytes, static_cast<std::uint32_t>(body.size()));
    const std::string checked = kind + body;
    bytes += checked;
    put_big(bytes, static_cast<std::uint32_t>(
                       crc32(0, reinterpret_cast<const Bytef*>(checked.data()), static_cast<uInt>(checked.size()))));
  };
  std::string header;
  put_big(header, static_cast<std::uint32_t>(picture.width()));
  put_big(header, static_cast<std::uint32_t>(picture.height()));
  header += std::string("\x08\x02\x00\x00\x00", 5);
  chunk("IHDR", header);
  chunk("IDAT", packed);
  chunk("IEND", "");
  return bytes;
}

/// An uncompressed TGA, lower row first.
inline std::string tga_bytes(const Image<Texel>& picture) {
  std::string bytes(18, '\0');
  bytes[2] = 2;
  bytes[12] = static_cast<char>(picture.width());
  bytes[14] = static_cast<char>(picture.height());
  bytes[16] = 24;
  for (int y = picture.height() - 1; y >= 0; --y)
    for (int x = 0; x < picture.width(); ++x)
      for (const std::uint8_t value : {picture(x, y).b, picture(x, y).g, picture(x, y).r})
        bytes.push_back(static_cast<char>(value));
  return bytes;
}

}  // namespace meniscus::tests
