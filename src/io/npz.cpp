#include <fmt/format.h>

#include <algorithm>

#include "io/frame_head.h"
#include "io/npy_arrays.h"
#include "io/readers.h"
#include "io/zip_members.h"

namespace meniscus::io {
namespace {

/// Adds a member's array; errors name the member.
void add_member(const Source& source, const std::string& name, NpyArrays& to) {
  try {
    add_npy(source, name, to);
  } catch (const Error& error) {
    ErrorDetail detail = error.detail();
    detail.problem = fmt::format("member '{}.npy': {}", name.substr(0, 60), detail.problem);
    throw Error(error.code(), std::move(detail));
  }
}

Particles particles_in(const Source& source, std::span<const ZipMember> members,
                       std::span<const UnpackedMember> unpacked, const ReadOptions& options) {
  NpyArrays arrays;
  for (std::size_t i = 0; i < members.size(); ++i)
    add_member(Source{source.path, unpacked[i].plain, unpacked[i].file},
               members[i].name.substr(0, members[i].name.size() - 4), arrays);
  return particles_of(arrays, options, source.path);
}

}  // namespace

Particles read_npz(const Source& source, const ReadOptions& options) {
  std::vector<ZipMember> members = zip_members(source);
  const auto is_array = [](const ZipMember& member) { return member.name.ends_with(".npy"); };
  if (std::none_of(members.begin(), members.end(), is_array))
    source.unsupported("is a zip archive without arrays of NumPy", "save arrays with numpy.savez()");
  std::erase_if(members, [&](const ZipMember& member) { return !is_array(member); });
  const std::vector<UnpackedMember> unpacked = unpack(source, members);
  // What is wrong in a damaged member is that it is damaged, whatever its bytes seem to say.
  Particles particles;
  try {
    particles = particles_in(source, members, unpacked, options);
  } catch (const Error&) {
    check_stored(source, members);
    throw;
  }
  check_stored(source, members);
  particles.format = "npz";
  return particles;
}

/// The directory is at the end: the size tells how many there can be, and the first member, if it is not packed, how
/// many there are.
void look_at_npz(const Source& start, FrameHead& head) {
  head.format = "npz";
  head.particles = head.plain_bytes / (3 * sizeof(float));
  constexpr std::size_t kLocalSize = 30;
  if (start.bytes.size() < kLocalSize) return;
  const auto number = [&](std::size_t at) {
    return static_cast<std::size_t>(read_value(Scalar::uint16, std::endian::little, start.bytes.data() + at));
  };
  const std::size_t first = kLocalSize + number(26) + number(28);
  if (number(8) != 0 || first >= start.bytes.size()) return;
  const Source member{start.path, start.bytes.subspan(first)};
  if (!member.starts_with("\x93NUMPY")) return;
  const std::optional<NpyHeader> header = npy_header_of(member);
  if (!header || header->shape.empty() || header->shape[0] == 0 || header->shape[0] > head.particles) return;
  head.particles = header->shape[0];
  head.values = std::max(3.0, static_cast<double>(head.plain_bytes) / static_cast<double>(4 * head.particles));
}

}  // namespace meniscus::io
