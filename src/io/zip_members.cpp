#include "io/zip_members.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <limits>

#include "io/file_bytes.h"
#include "io/inflater.h"
#include "io/values.h"

namespace meniscus::io {
namespace {

constexpr std::size_t kEndSize = 22;          ///< of the end of the directory, without its comment
constexpr std::size_t kLocatorSize = 20;      ///< of zip64's locator before it
constexpr std::size_t kEnd64Size = 56;        ///< of zip64's end
constexpr std::size_t kEntrySize = 46;        ///< of an entry of the directory, without its name
constexpr std::size_t kLocalSize = 30;        ///< of the header before a member
constexpr std::uint64_t kMostDeflate = 1032;  ///< bytes out of one packed byte
constexpr std::uint32_t kNone32 = 0xffffffffu;

/// Little-endian numbers at byte offsets that have been checked.
struct Fields {
  const Source& source;
  std::uint16_t u16(std::size_t at) const {
    return static_cast<std::uint16_t>(static_cast<unsigned char>(source.bytes[at]) |
                                      static_cast<unsigned char>(source.bytes[at + 1]) << 8);
  }
  std::uint32_t u32(std::size_t at) const { return u16(at) | static_cast<std::uint32_t>(u16(at + 2)) << 16; }
  std::uint64_t u64(std::size_t at) const { return u32(at) | static_cast<std::uint64_t>(u32(at + 4)) << 32; }
};

struct Directory {
  std::uint64_t first = 0, size = 0, entries = 0;
};

/// From the end of the archive, which a comment of up to 64 KiB may follow.
Directory directory_of(const Source& source) {
  const Fields fields{source};
  const std::size_t size = source.bytes.size();
  const std::size_t least = size > kEndSize + 0xffff ? size - kEndSize - 0xffff : 0;
  std::size_t end = size < kEndSize ? 0 : size - kEndSize + 1;
  const auto is_end = [&](std::size_t at) {
    return fields.u32(at) == 0x06054b50u && at + kEndSize + fields.u16(at + 20) <= size;
  };
  source.need(least, size - least);
  while (end > least && !is_end(end - 1)) --end;
  if (end <= least)
    source.malformed("is no whole zip archive: the directory at its end is missing", size, "PK\\5\\6", {});
  const std::size_t at = end - 1;
  if (fields.u16(at + 4) != 0 && fields.u16(at + 4) != 0xffff) source.unsupported("is one volume of a zip archive");
  Directory directory{fields.u32(at + 16), fields.u32(at + 12), fields.u16(at + 10)};
  const bool wide = directory.first == kNone32 || directory.size == kNone32 || directory.entries == 0xffff;
  if (wide && at >= kLocatorSize) source.need(at - kLocatorSize, kLocatorSize);
  if (wide && at >= kLocatorSize && fields.u32(at - kLocatorSize) == 0x07064b50u) {
    const std::uint64_t place = fields.u64(at - kLocatorSize + 8);
    source.require(place, 1, kEnd64Size, "zip64 directory");
    source.need(place, kEnd64Size);
    const auto wide_end = static_cast<std::size_t>(place);
    if (fields.u32(wide_end) != 0x06064b50u) source.malformed("has no zip64 directory where it says", place);
    directory = {fields.u64(wide_end + 48), fields.u64(wide_end + 40), fields.u64(wide_end + 32)};
  }
  source.require(directory.first, directory.size, 1, "directory");
  source.need(directory.first, directory.size);
  if (directory.entries > directory.size / kEntrySize)
    source.malformed("its directory is too short for its members", at, fmt::format("{} members", directory.entries),
                     fmt::format("{} bytes", directory.size));
  return directory;
}

/// The sizes and the place that zip64's extra field gives where 32 bits do not do.
void read_extra(const Fields& fields, std::size_t at, std::size_t end, std::initializer_list<std::uint64_t*> wanted) {
  while (at + 4 <= end) {
    const std::size_t size = fields.u16(at + 2);
    if (fields.u16(at) == 1) {
      std::size_t value = at + 4;
      for (std::uint64_t* target : wanted) {
        if (*target != kNone32) continue;
        if (value + 8 > std::min(end, at + 4 + size)) return;
        *target = fields.u64(value);
        value += 8;
      }
      return;
    }
    at += 4 + size;
  }
}

void check_sum(const Source& source, const ZipMember& member, std::uint32_t sum) {
  if (sum != member.crc)
    source.malformed(fmt::format("the member '{}' is damaged", member.name.substr(0, 60)), member.first,
                     fmt::format("the sum {:08x}", member.crc), fmt::format("{:08x}", sum));
}

/// Raw deflate, which is in memory, into memory of the size that was declared.
Bytes inflated(const Source& source, const ZipMember& member) {
  const Inflater inflater = make_inflater();
  Bytes bytes(static_cast<std::size_t>(member.size));
  std::size_t read = 0, written = 0;
  const libdeflate_result result = libdeflate_deflate_decompress_ex(inflater.get(), source.bytes.data() + member.first,
                                                                    static_cast<std::size_t>(member.packed_size),
                                                                    bytes.data(), bytes.size(), &read, &written);
  const bool is_more = result == LIBDEFLATE_INSUFFICIENT_SPACE;
  if (result == LIBDEFLATE_SUCCESS && written == bytes.size()) return bytes;
  source.malformed(fmt::format("the member '{}' is damaged", member.name.substr(0, 60)), member.first,
                   fmt::format("{} bytes when unpacked", member.size),
                   is_more                        ? "more"
                   : result == LIBDEFLATE_SUCCESS ? fmt::format("{}", written)
                                                  : "no deflated data");
}

}  // namespace

std::vector<ZipMember> zip_members(const Source& source) {
  const Directory directory = directory_of(source);
  const Fields fields{source};
  std::vector<ZipMember> members;
  auto at = static_cast<std::size_t>(directory.first);
  const auto end = static_cast<std::size_t>(directory.first + directory.size);
  for (std::uint64_t i = 0; i < directory.entries; ++i) {
    if (end - at < kEntrySize || fields.u32(at) != 0x02014b50u)
      source.malformed("the directory of its members is damaged", at, "PK\\1\\2");
    ZipMember member;
    const unsigned flags = fields.u16(at + 8), method = fields.u16(at + 10);
    member.crc = fields.u32(at + 16);
    member.packed_size = fields.u32(at + 20);
    member.size = fields.u32(at + 24);
    std::uint64_t local = fields.u32(at + 42);
    const std::size_t name = fields.u16(at + 28), extra = fields.u16(at + 30), comment = fields.u16(at + 32);
    source.require(at + kEntrySize, name + extra + comment, 1, "directory");
    source.need(at + kEntrySize, name + extra + comment);
    member.name.assign(source.bytes.data() + at + kEntrySize, name);
    read_extra(fields, at + kEntrySize + name, at + kEntrySize + name + extra,
               {&member.size, &member.packed_size, &local});
    at += kEntrySize + name + extra + comment;
    if (at > end) source.malformed("the directory of its members is damaged", at);

    if ((flags & 1u) != 0) source.unsupported("is an encrypted zip archive", "save it without a password");
    if (method != 0 && method != 8)
      source.unsupported(fmt::format("its member '{}' is packed by method {}", member.name.substr(0, 60), method),
                         "pack it with deflate, as numpy.savez_compressed() does");
    member.deflated = method == 8;
    source.require(local, 1, kLocalSize, "members");
    source.need(local, kLocalSize);
    const auto before = static_cast<std::size_t>(local);
    if (fields.u32(before) != 0x04034b50u)
      source.malformed(fmt::format("its member '{}' is not where the directory says", member.name.substr(0, 60)),
                       local);
    member.first = before + kLocalSize + fields.u16(before + 26) + fields.u16(before + 28);
    source.require(member.first, member.packed_size, 1, "members");
    const bool believable =
        member.deflated ? member.size <= kMostDeflate * member.packed_size + 64 : member.size == member.packed_size;
    if (!believable)
      source.malformed(fmt::format("its member '{}' cannot be as large as it says", member.name.substr(0, 60)), local,
                       fmt::format("{} bytes", member.size), fmt::format("{} bytes packed", member.packed_size));
    members.push_back(std::move(member));
  }
  return members;
}

std::vector<UnpackedMember> unpack(const Source& source, std::span<const ZipMember> members) {
  std::uint64_t all = 0;
  const std::uint64_t most = believable_size(source.bytes.size());
  for (const ZipMember& member : members)
    if (all <= most) all += member.size;  // a member is at most 1032 times the file: no overflow
  if (all > most)
    throw Error(ErrorCode::limit_exceeded,
                {"its members are larger than what particles would be when unpacked",
                 fmt::format("at most {} bytes", most), fmt::format("{} bytes or more", all), source.path, std::nullopt,
                 std::nullopt, "unpack the archive first if it is sound"});
  for (const ZipMember& member : members)
    if (member.deflated) source.need(member.first, member.packed_size);
  std::vector<UnpackedMember> unpacked(members.size());
  parallel_for(members.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const ZipMember& member = members[i];
      const auto size = static_cast<std::size_t>(member.size);
      if (member.deflated) unpacked[i].owned = inflated(source, member);
      unpacked[i].plain = member.deflated ? unpacked[i].owned.span() : source.bytes.subspan(member.first, size);
      unpacked[i].file = member.deflated ? nullptr : source.file;
      // What stays in a file is checked when it has been read.
      if (unpacked[i].file == nullptr) check_sum(source, member, crc32_of(Stored(unpacked[i].plain.data()), size));
    }
  });
  if (source.file != nullptr) source.file->keep_sums();
  return unpacked;
}

void check_stored(const Source& source, std::span<const ZipMember> members) {
  if (source.file == nullptr) return;
  for (const ZipMember& member : members)
    if (!member.deflated)
      check_sum(source, member,
                source.file->crc32_of(source.bytes.data() + member.first, static_cast<std::size_t>(member.size)));
}

}  // namespace meniscus::io
