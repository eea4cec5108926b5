// Whatever happens to a file of VTK's XML formats: it is read whole, or refused with an error that names it.
#include <fmt/format.h>

#include <array>

#include "small_frames.h"

namespace meniscus {
namespace {

/// Whether a file is read. Where it is refused the error names it.
bool is_read(const std::string& path) {
  try {
    const Particles particles = read_particles(path);
    for (const Attribute& attribute : particles.attributes)
      EXPECT_EQ(attribute.values.size(), particles.size() * static_cast<std::size_t>(attribute.components));
    return true;
  } catch (const Error& error) {
    EXPECT_EQ(error.detail().path, path);
    return false;
  }
}

const std::vector<std::string> kSamples{"ascii.vtp",       "inline_64.vtp",       "inline_zlib.vtu", "raw_big.vtu",
                                        "raw_zlib_64.vtu", "base64_zlib_big.vtu", "base64_64.vtp",   "two_pieces.vtu"};

#ifdef MENISCUS_SANITIZED
constexpr std::size_t kStep = 7;  // of all bytes: each file takes ten times as long there
#else
constexpr std::size_t kStep = 1;
#endif

TEST(EveryPrefix, OfVtkXmlIsRefusedUntilItIsWhole) {
  const Scratch scratch;
  for (const std::string& name : kSamples) {
    const std::string bytes = bytes_of_file(sample(name));
    const std::size_t whole = bytes.rfind("</VTKFile") + 9;
    ASSERT_TRUE(is_read(scratch.write(name, bytes)));
    for (std::size_t size = 0; size < whole; size += kStep)
      ASSERT_FALSE(is_read(scratch.write(name, std::string_view(bytes).substr(0, size)))) << name << ": " << size;
  }
}

TEST(EveryChangedByte, OfVtkXmlIsReadOrRefused) {
  const Scratch scratch;
  for (const std::string& name : kSamples) {
    const std::string bytes = bytes_of_file(sample(name));
    for (std::size_t at = 0; at < bytes.size(); at += kStep) {
      std::string damaged = bytes;
      damaged[at] = static_cast<char>(damaged[at] ^ (at % 2 == 0 ? 0x01 : 0xff));
      is_read(scratch.write(name, damaged));
    }
  }
}

TEST(ExtraBytes, BehindVtkXmlChangeNothing) {
  const Scratch scratch;
  for (const std::string& name : kSamples)
    expect_small(read_particles(scratch.write(name, bytes_of_file(sample(name)) + "\n\n  \n")));
}

/// Appended raw data of one array of compressed words, and a file that says they are so many points.
std::string compressed(const std::string& points, const std::string& appended) {
  return fmt::format(
             "<VTKFile type=\"PolyData\" header_type=\"UInt64\" compressor=\"vtkZLibDataCompressor\"><PolyData>"
             "<Piece NumberOfPoints=\"{}\"><Points><DataArray type=\"Float32\" NumberOfComponents=\"3\" "
             "format=\"appended\" offset=\"0\"/></Points></Piece></PolyData><AppendedData encoding=\"raw\">_",
             points) +
         appended + "</AppendedData></VTKFile>";
}

std::string deflated(std::string_view bytes) {
  std::string packed(compressBound(bytes.size()), '\0');
  uLongf size = packed.size();
  compress2(reinterpret_cast<Bytef*>(packed.data()), &size, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size(),
            9);
  packed.resize(size);
  return packed;
}

/// Reads a file that must be refused without the process growing by more than 16 MiB.
Error refused_within_little(const std::string& path) {
  const std::uint64_t before = peak_rss_bytes();
  Error error = refused(path);
  EXPECT_LT(peak_rss_bytes() - before, std::uint64_t{16} << 20) << path;
  return error;
}

TEST(AbsurdCounts, InHeadersOfCompressedArraysAreRefused) {
  const Scratch scratch;
  const std::string packed = deflated(std::string(24, '\x01'));
  const std::vector<std::uint64_t> extremes{0, 1, 23, 25, 1u << 31, std::uint64_t{1} << 63, ~std::uint64_t{0}};
  const std::array<std::uint64_t, 4> good{1, 24, 24, packed.size()};
  const auto bytes_with = [&](const std::array<std::uint64_t, 4>& words) {
    ByteWriter out(std::endian::little);
    for (const std::uint64_t word : words) out.put(word);
    return compressed("2", out.bytes() + packed);
  };
  EXPECT_EQ(read_particles(scratch.write("f.vtp", bytes_with(good))).size(), 2u);
  for (std::size_t i = 0; i < 4; ++i) {
    for (const std::uint64_t extreme : extremes) {
      std::array<std::uint64_t, 4> words = good;
      // A last block that is full may be told so or not, and the only one may be less than a block.
      if (extreme == words[i] || (i == 2 && extreme == 0) || (i == 1 && extreme > 24)) continue;
      words[i] = extreme;
      EXPECT_EQ(refused_within_little(scratch.write("f.vtp", bytes_with(words))).code(), ErrorCode::malformed_file)
          << i << " " << extreme;
    }
  }
}

TEST(AbsurdCounts, OfPointsInVtkXmlAreRefused) {
  const Scratch scratch;
  for (const char* points : {"3", "2147483648", "4294967296", "9223372036854775808", "18446744073709551615"}) {
    ByteWriter out(std::endian::little);
    for (const std::uint64_t word : {1, 24, 24, 10}) out.put(word);
    refused_within_little(scratch.write("f.vtp", compressed(points, out.bytes() + std::string(10, 'x'))));
    std::string plain = compressed(points, out.bytes() + std::string(100, 'x'));
    plain.erase(plain.find(" compressor"), std::string(" compressor=\"vtkZLibDataCompressor\"").size());
    refused_within_little(scratch.write("g.vtp", plain));
  }
}

TEST(AbsurdCounts, OfArraysThatNameTheSameBytesAreRefused) {
  const Scratch scratch;
  const auto bytes_with = [](int arrays) {
    std::string text =
        "<VTKFile type=\"PolyData\"><PolyData><Piece NumberOfPoints=\"10000\"><Points><DataArray "
        "type=\"Float32\" NumberOfComponents=\"3\" format=\"appended\" offset=\"0\"/></Points><PointData>";
    for (int i = 0; i < arrays; ++i)
      text += fmt::format(
          "<DataArray type=\"Float32\" Name=\"a{}\" NumberOfComponents=\"3\" format=\"appended\" "
          "offset=\"0\"/>",
          i);
    return text + "</PointData></Piece></PolyData><AppendedData encoding=\"raw\">_" +
           ByteWriter(std::endian::little).put(std::uint32_t{120'000}).bytes() + std::string(120'000, '\0') +
           "</AppendedData></VTKFile>";
  };
  EXPECT_EQ(read_particles(scratch.write("a.vtp", bytes_with(1))).size(), 10'000u);
  EXPECT_EQ(refused_within_little(scratch.write("b.vtp", bytes_with(1000))).code(), ErrorCode::limit_exceeded);
  EXPECT_EQ(refused_within_little(scratch.write("c.vtp", bytes_with(2000))).code(), ErrorCode::malformed_file);
}

TEST(CompressedBomb, IsRefusedBeforeItIsInflated) {
  // More than a gibibyte in blocks of three mebibytes of zeros: a thousand to one.
  const Scratch scratch;
  const std::uint64_t block = 3 << 20, count = 400;
  const std::string packed = deflated(std::string(block, '\0'));
  ByteWriter out(std::endian::little);
  out.put(count).put(block).put(std::uint64_t{0});
  std::string blocks;
  for (std::uint64_t i = 0; i < count; ++i) {
    out.put<std::uint64_t>(packed.size());
    blocks += packed;
  }
  const std::string path = scratch.write("f.vtp", compressed(std::to_string(count * block / 12), out.bytes() + blocks));
  EXPECT_EQ(refused_within_little(path).code(), ErrorCode::limit_exceeded);
}

}  // namespace
}  // namespace meniscus
