#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <bit>
#include <cstring>
#include <set>

#include "base/temporary_file.h"
#include "io/npy_arrays.h"
#include "io/particle_writers.h"

namespace meniscus::io {
namespace {

static_assert(std::endian::native == std::endian::little, "arrays are written as they are in memory");

void u16(std::string& bytes, std::uint64_t value) {
  for (int shift = 0; shift < 16; shift += 8) bytes += static_cast<char>(value >> shift & 0xffu);
}
void u32(std::string& bytes, std::uint64_t value) {
  u16(bytes, value);
  u16(bytes, value >> 16);
}
void u64(std::string& bytes, std::uint64_t value) {
  u32(bytes, value);
  u32(bytes, value >> 32);
}

/// A zip archive of stored members; all sizes and places in 64 bits, so that none is too large.
class Archive {
 public:
  explicit Archive(const std::string& path) : stream_(path) {}

  /// Adds a member of a head and values behind it.
  void add(const std::string& name, const std::string& head, std::span<const char> values) {
    uLong crc = crc32_z(0, reinterpret_cast<const Bytef*>(head.data()), head.size());
    // zlib takes a null pointer, which no values may have, for a new beginning.
    if (!values.empty()) crc = crc32_z(crc, reinterpret_cast<const Bytef*>(values.data()), values.size());
    const std::uint64_t size = head.size() + values.size();
    const std::uint64_t at = at_;
    std::string local;
    local += "PK\x03\x04";
    u16(local, kVersion);
    put_about(local, crc, name);
    u16(local, 20);  // bytes of the extra field
    local += name;
    u16(local, 1);
    u16(local, 16);
    u64(local, size);
    u64(local, size);
    put(local);
    put(head);
    put(values);

    directory_ += "PK\x01\x02";
    u16(directory_, kVersion);
    u16(directory_, kVersion);
    put_about(directory_, crc, name);
    u16(directory_, 28);
    for (const int bytes : {2, 2, 2, 4}) directory_.append(static_cast<std::size_t>(bytes), '\0');
    u32(directory_, kWide);
    directory_ += name;
    u16(directory_, 1);
    u16(directory_, 24);
    u64(directory_, size);
    u64(directory_, size);
    u64(directory_, at);
    ++members_;
  }

  void commit() {
    const std::uint64_t directory = at_, wide_end = at_ + directory_.size();
    std::string end = "PK\x06\x06";
    u64(end, 44);  // bytes that follow
    u16(end, kVersion);
    u16(end, kVersion);
    u32(end, 0);
    u32(end, 0);
    u64(end, members_);
    u64(end, members_);
    u64(end, directory_.size());
    u64(end, directory);
    end += "PK\x06\x07";
    u32(end, 0);
    u64(end, wide_end);
    u32(end, 1);
    end += "PK\x05\x06";
    u32(end, 0);
    u16(end, 0xffff);
    u16(end, 0xffff);
    u32(end, kWide);
    u32(end, kWide);
    u16(end, 0);
    put(directory_);
    put(end);
    stream_.commit();
  }

 private:
  static constexpr std::uint64_t kVersion = 45;  ///< of zip, the first with 64-bit sizes
  static constexpr std::uint64_t kWide = 0xffffffff;

  /// What both headers of a member have alike, up to the length of its name.
  static void put_about(std::string& bytes, std::uint64_t crc, const std::string& name) {
    const bool is_ascii = std::all_of(name.begin(), name.end(), [](char c) { return c >= 0; });
    u16(bytes, is_ascii ? 0 : 0x800);  // names are UTF-8
    u16(bytes, 0);                     // stored
    u16(bytes, 0);
    u16(bytes, 0x21);  // the first day that zip knows
    u32(bytes, crc);
    u32(bytes, kWide);
    u32(bytes, kWide);
    u16(bytes, name.size());
  }
  void put(std::span<const char> bytes) {
    stream_.write(bytes);
    at_ += bytes.size();
  }

  TemporaryStream stream_;
  std::string directory_;
  std::uint64_t at_ = 0, members_ = 0;
};

template <class T>
std::span<const char> bytes_of(const std::vector<T>& values) {
  return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)};
}

/// Interleaved, with the origin added in doubles.
template <class T>
std::vector<T> interleaved(const Particles& particles, const glm::dvec3& origin) {
  std::vector<T> values(3 * particles.size());
  parallel_for(particles.size(), 1 << 16, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const vec3 position = particles.position(i);
      for (int axis = 0; axis < 3; ++axis) {
        const auto at = 3 * i + static_cast<std::size_t>(axis);
        if constexpr (sizeof(T) == sizeof(float)) {
          values[at] = position[axis];
        } else {
          values[at] = origin[axis] + static_cast<double>(position[axis]);
        }
      }
    }
  });
  return values;
}

/// A member's name that no other has, without what zip or file systems take for something else.
std::string member_name(std::string name, std::set<std::string>& taken) {
  for (char& c : name)
    if (static_cast<unsigned char>(c) < ' ' || c == '/' || c == '\\' || c == '\x7f') c = '_';
  constexpr std::size_t kMost = 1000;
  if (name.size() > kMost) name.resize(kMost);
  while (!taken.insert(name).second) name += '_';
  return name + ".npy";
}

}  // namespace

void write_npz(const std::string& path, const Particles& particles) {
  check_lengths(path, particles);
  Archive archive(path);
  const std::uint64_t count = particles.size();
  const std::uint64_t shape[] = {count, 3};
  if (has_origin(particles)) {
    archive.add("positions.npy", npy_header("<f8", shape), bytes_of(interleaved<double>(particles, particles.origin)));
  } else {
    archive.add("positions.npy", npy_header("<f4", shape), bytes_of(interleaved<float>(particles, {})));
  }
  // Names that would be read as something else are not for attributes.
  std::set<std::string> taken{"positions", "time", "t", "spacing", "up", "x", "y", "z"};
  for (const Attribute& attribute : particles.attributes) {
    std::vector<std::uint64_t> lengths{count};
    if (attribute.components > 1) lengths.push_back(static_cast<std::uint64_t>(attribute.components));
    archive.add(member_name(attribute.name, taken), npy_header("<f4", lengths), bytes_of(attribute.values));
  }
  const auto add_number = [&](const std::string& name, double value) {
    archive.add(name, npy_header("<f8", {}), bytes_of(std::vector<double>{value}));
  };
  if (particles.time) add_number("time.npy", *particles.time);
  if (particles.spacing) add_number("spacing.npy", static_cast<double>(*particles.spacing));
  if (particles.up) {
    const std::vector<std::uint32_t> letter{static_cast<std::uint32_t>(name_of(*particles.up)[0])};
    archive.add("up.npy", npy_header("<U1", {}), bytes_of(letter));
  }
  archive.commit();
}

}  // namespace meniscus::io
