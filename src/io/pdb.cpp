// Maya's particles, PDB: a header, then channel after channel, in structs with pointers of 32 or of 64 bits, as the
// compiler of the program that wrote them laid them out. Nothing in the header tells which.
#include <fmt/format.h>

#include <algorithm>
#include <cstring>

#include "io/frame_head.h"
#include "io/number_arrays.h"
#include "io/readers.h"

namespace meniscus::io {
namespace {

constexpr double kMagic = 670;
constexpr std::size_t kVersion = 8, kCount = 16, kChannels = 20;  ///< bytes from the start
constexpr std::uint64_t kMostChannels = 65536;
constexpr std::size_t kBefore = 6;  ///< bytes before each channel

/// Sizes of the structs, in bytes.
struct Layout {
  std::size_t header;
  std::size_t channel;
  std::size_t type;  ///< where the type is in the channel
  std::size_t data;  ///< type, bytes a particle, and three more; behind the name
};
constexpr Layout kShort{60, 36, 4, 20}, kLong{64, 56, 8, 24};

/// The type of a channel's numbers; none for characters, pointers and what is unknown.
std::optional<Scalar> scalar_of(std::uint32_t type) {
  if (type == 1 || type == 2) return Scalar::float32;  // vectors and reals
  if (type == 3) return Scalar::int32;
  return std::nullopt;
}

std::endian order_of(const Source& source) {
  return read_value(Scalar::uint32, std::endian::little, source.bytes.data()) == kMagic ? std::endian::little
                                                                                        : std::endian::big;
}

std::uint32_t word_at(const Source& source, std::size_t at) {
  return static_cast<std::uint32_t>(read_value(Scalar::uint32, order_of(source), source.bytes.data() + at));
}

/// The channels, or where the layout does not fit the file.
struct Channels {
  std::vector<NumberArray> arrays;
  bool fit = false;
  std::size_t at = 0;  ///< byte offset behind the last one that fits
  std::string problem;
};

/// A channel is believed where its two types are the same and its bytes are there.
bool add_channel(const Source& source, const Layout& layout, std::uint64_t count, Channels& channels) {
  const std::uint64_t size = source.bytes.size();
  const std::size_t channel = channels.at + kBefore, name = channel + layout.channel;
  channels.problem = "the file ends inside its channels";
  if (name >= size) return false;
  const auto* first = source.bytes.data() + name;
  const auto* end = static_cast<const char*>(std::memchr(first, '\0', size - name));
  if (end == nullptr || layout.data > size - name - static_cast<std::size_t>(end - first) - 1) return false;
  const std::size_t data = name + static_cast<std::size_t>(end - first) + 1;
  const std::uint32_t type = word_at(source, data), bytes = word_at(source, data + 4);
  if (count > 0 && bytes > (size - data - layout.data) / count) return false;
  channels.problem = "a channel is damaged";
  const bool is_whole = !scalar_of(type) || bytes % sizeof(float) == 0;
  if (word_at(source, channel + layout.type) != type || !is_whole) return false;

  NumberArray array;
  array.name.assign(first, end);
  array.type = scalar_of(type);
  array.type_name = array.type ? std::string(name_of(*array.type)) : fmt::format("{} of Maya", type);
  array.order = order_of(source);
  array.shape = {count};
  if (array.type && bytes != sizeof(float)) array.shape.push_back(bytes / sizeof(float));
  array.first = source.bytes.data() + data + layout.data;
  array.stride = bytes;
  array.step = sizeof(float);
  channels.arrays.push_back(std::move(array));
  channels.at = data + layout.data + static_cast<std::size_t>(count * bytes);
  return true;
}

Channels channels_of(const Source& source, const Layout& layout, std::uint64_t count, std::uint64_t wanted) {
  Channels channels;
  channels.at = layout.header;
  for (std::uint64_t i = 0; i < wanted; ++i)
    if (!add_channel(source, layout, count, channels)) return channels;
  channels.fit = channels.at == source.bytes.size();
  channels.problem = channels.at < source.bytes.size() ? "there is more behind its channels than its header says"
                                                       : "the file ends inside its header";
  return channels;
}

std::uint64_t channel_count_of(const Source& source) {
  source.require(0, 1, kShort.header, "header");
  const std::uint32_t channels = word_at(source, kChannels);
  if (channels > kMostChannels)
    source.malformed("has an impossible number of channels", kChannels, fmt::format("at most {}", kMostChannels),
                     fmt::format("{}", channels));
  return channels;
}

}  // namespace

bool is_pdb(const Source& start) {
  if (start.bytes.size() < kVersion + sizeof(float)) return false;
  const std::endian order = order_of(start);
  const double version = read_value(Scalar::float32, order, start.bytes.data() + kVersion);
  return read_value(Scalar::uint32, order, start.bytes.data()) == kMagic && version >= 1 && version < 100;
}

void look_at_pdb(const Source& start, FrameHead& head) {
  channel_count_of(start);
  head.format = "pdb";
  head.particles = word_at(start, kCount);
  head.counted = true;
  if (head.particles == 0) return;
  if (head.particles > head.plain_bytes / (3 * sizeof(float)))
    start.malformed("the file is shorter than its particles", kCount);
  head.values =
      std::max(3.0, static_cast<double>(head.plain_bytes / sizeof(float)) / static_cast<double>(head.particles));
}

Particles read_pdb(const Source& source, const ReadOptions& options) {
  const std::uint64_t wanted = channel_count_of(source), count = word_at(source, kCount);
  Channels channels = channels_of(source, kShort, count, wanted);
  if (!channels.fit) {
    Channels wide = channels_of(source, kLong, count, wanted);
    if (wide.fit || wide.arrays.size() > channels.arrays.size()) channels = std::move(wide);
  }
  if (!channels.fit) source.malformed(channels.problem, channels.at);
  Particles particles;
  particles.format = "pdb";
  if (wanted == 0 && count == 0) return particles;
  const PositionArrays found = choose_positions(channels.arrays, options, source.path);
  set_positions(channels.arrays, found, options, particles);
  add_attributes(channels.arrays, found, particles);
  return particles;
}

}  // namespace meniscus::io
