#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "io/base64.h"
#include "io/inflater.h"
#include "io/text.h"
#include "io/text_numbers.h"
#include "io/vtk_xml_file.h"

namespace meniscus::io {
namespace {

constexpr std::array<std::pair<std::string_view, Scalar>, 10> kTypes{{{"Float32", Scalar::float32},
                                                                      {"Float64", Scalar::float64},
                                                                      {"Int8", Scalar::int8},
                                                                      {"UInt8", Scalar::uint8},
                                                                      {"Int16", Scalar::int16},
                                                                      {"UInt16", Scalar::uint16},
                                                                      {"Int32", Scalar::int32},
                                                                      {"UInt32", Scalar::uint32},
                                                                      {"Int64", Scalar::int64},
                                                                      {"UInt64", Scalar::uint64}}};

constexpr std::uint64_t kMostComponents = 65536;
constexpr std::string_view kZlib = "vtkZLibDataCompressor";

/// The numbers in attributes `offset` of an element and of all below it.
void add_offsets(const XmlElement& element, std::vector<std::uint64_t>& offsets) {
  std::uint64_t offset = 0;
  if (parse_count(element.value("offset"), offset)) offsets.push_back(offset);
  for (const XmlElement& child : element.children) add_offsets(child, offsets);
}

std::string shown_name(const XmlElement& array) { return fmt::format("array '{:.40}'", array.value("Name")); }

}  // namespace

/// The bytes of one array, plain or in base64, from its length on.
class VtkXmlArrays::Stream {
 public:
  Stream(const VtkXmlFile& file, std::string name, std::size_t begin, std::size_t end, bool base64)
      : file_(file), name_(std::move(name)), begin_(begin), end_(end), base64_(base64) {}

  /// The first `count` bytes, in memory. What was given before becomes invalid.
  const char* first(std::uint64_t count) {
    if (!base64_) file_.source.need(begin_, count);
    return stored(count).at;
  }
  /// Where the first `count` bytes stand; in a file they may have to be fetched.
  Stored stored(std::uint64_t count) {
    const std::uint64_t there = base64_ ? (end_ - begin_) / 4 * 3 : end_ - begin_;
    if (count <= there) {
      if (!base64_) return file_.source.stored(begin_);
      if (decoded_.size < count) decoded_ = decode_base64(file_.source, begin_, end_, count);
      if (decoded_.size >= count) return decoded_.bytes.data();
    }
    malformed("ends early", fmt::format("{} bytes", count),
              fmt::format("{} bytes", base64_ && count <= there ? decoded_.size : there));
  }
  std::size_t begin() const { return begin_; }
  /// Whether bytes lie in the file itself.
  bool in_file() const { return !base64_; }
  Bytes take() { return std::move(decoded_.bytes); }

  [[noreturn]] void malformed(std::string_view problem, std::string expected = {}, std::string found = {}) const {
    file_.source.malformed(fmt::format("{} {}", name_, problem), begin_, std::move(expected), std::move(found));
  }
  [[noreturn]] void too_much() const {
    throw Error(ErrorCode::limit_exceeded, {fmt::format("{} grows beyond what particles would", name_),
                                            {},
                                            {},
                                            file_.source.path,
                                            begin_,
                                            {},
                                            "write the file without compression if it is sound"});
  }

 private:
  const VtkXmlFile& file_;
  std::string name_;
  std::size_t begin_, end_;
  bool base64_;
  DecodedBase64 decoded_;
};

std::optional<Scalar> VtkXmlArrays::type_of(const XmlElement& array) const {
  const std::string type = array.value("type");
  for (const auto& [known, scalar] : kTypes)
    if (type == known) return scalar;
  return std::nullopt;
}

std::uint64_t VtkXmlArrays::word(const char* first) const {
  std::uint64_t value = 0;
  const std::size_t size = size_of(file_.header);
  for (std::size_t i = 0; i < size; ++i)
    value = value << 8 | static_cast<unsigned char>(first[file_.order == std::endian::big ? i : size - 1 - i]);
  return value;
}

VtkXmlArray VtkXmlArrays::read(const XmlElement& array, std::uint64_t tuples, std::uint64_t components) {
  const Source& source = file_.source;
  const std::optional<Scalar> type = type_of(array);
  if (!type) source.malformed(shown_name(array) + " holds no numbers", array.at);
  if (components == 0 || components > kMostComponents)
    source.malformed(shown_name(array) + " has an impossible number of components", array.at, {},
                     fmt::format("{}", components));
  // No file has so many values: what follows need not fear an overflow.
  if (tuples > (std::uint64_t{1} << 56) / components / size_of(*type))
    source.malformed(shown_name(array) + " has an impossible number of values", array.at, {},
                     fmt::format("{}", tuples));
  const std::uint64_t values = tuples * components, bytes = values * size_of(*type);

  const std::string format = lower(array.value("format", "ascii"));
  if (format == "ascii") return read_text(array, *type, values);
  std::size_t begin = array.text_begin, end = array.text_end;
  if (format == "appended") {
    const std::uint64_t offset = xml_count(source, array, "offset");
    if (offset > file_.appended_end - file_.appended_begin)
      source.malformed(shown_name(array) + " begins behind the end of the appended data", array.at,
                       fmt::format("at most {}", file_.appended_end - file_.appended_begin), fmt::format("{}", offset));
    begin = file_.appended_begin + static_cast<std::size_t>(offset);
    end = file_.appended_end;
  } else if (format != "binary") {
    source.malformed(shown_name(array) + " is of an unknown format", array.at, "ascii, binary or appended",
                     "'" + format.substr(0, 24) + "'");
  }
  Stream stream(file_, shown_name(array), begin, end, format == "binary" || file_.appended_base64);
  // Many arrays may name the same bytes; all together they are no more than the file can stand for.
  const std::uint64_t size = source.bytes.size();
  made_ += bytes;
  if (made_ / 2 > (file_.compressor.empty() ? size : believable_size(size))) stream.too_much();
  VtkXmlArray result = file_.compressor.empty() ? read_plain(stream, bytes) : read_compressed(stream, bytes);
  result.type = *type;
  result.order = file_.order;
  return result;
}

VtkXmlArray VtkXmlArrays::read_text(const XmlElement& array, Scalar type, std::uint64_t values) const {
  const std::uint64_t room = array.text_end - array.text_begin;
  if (values > room / 2 + 1)
    file_.source.malformed(shown_name(array) + " ends early", array.text_begin, fmt::format("{} values", values),
                           fmt::format("{} bytes", room));
  const auto count = static_cast<std::size_t>(values);
  const std::string what = shown_name(array);
  VtkXmlArray result;
  TextNumbers read;
  if (size_of(type) < 4 || type == Scalar::float32) {
    result.type = Scalar::float32;
    result.owned = Bytes(count * sizeof(float));
    const std::span target(reinterpret_cast<float*>(result.owned.data()), count);
    read = read_numbers(file_.source, array.text_begin, array.text_end, target, what);
  } else {
    result.type = Scalar::float64;
    result.owned = Bytes(count * sizeof(double));
    const std::span target(reinterpret_cast<double*>(result.owned.data()), count);
    read = read_numbers(file_.source, array.text_begin, array.text_end, target, what);
  }
  const Source text{file_.source.path, file_.source.bytes.first(array.text_end)};
  if (read.count < count || !TextCursor(text, read.end).peek().empty())
    file_.source.malformed(fmt::format("{} has too {} values", what, read.count < count ? "few" : "many"), read.end,
                           fmt::format("{}", values));
  result.first = result.owned.data();
  return result;
}

bool VtkXmlArrays::begins_at(std::uint64_t offset) {
  if (offsets_.empty()) {
    add_offsets(file_.root, offsets_);
    std::sort(offsets_.begin(), offsets_.end());
  }
  return std::binary_search(offsets_.begin(), offsets_.end(), offset);
}

VtkXmlArray VtkXmlArrays::read_plain(Stream& stream, std::uint64_t bytes) {
  const std::uint64_t size = size_of(file_.header);
  const std::uint64_t length = word(stream.first(size));
  // Lengths of 32 bits wrap around in files of some writers.
  const std::uint64_t most = size == 4 ? 0xffffffffu : ~std::uint64_t{0};
  // GPUSPH splits vectors of four and gives the parts four times their length; the next array begins where it should.
  const bool fourfold = stream.in_file() && length == (4 * bytes & most) &&
                        begins_at(stream.begin() - file_.appended_begin + size + bytes);
  if (length != (bytes & most) && !fourfold)
    stream.malformed("has another length than its count asks for", fmt::format("{} bytes", bytes),
                     fmt::format("{} bytes", length));
  VtkXmlArray result;
  result.first = stream.stored(size + bytes) + static_cast<std::size_t>(size);
  if (!stream.in_file()) result.owned = stream.take();
  return result;
}

VtkXmlArray VtkXmlArrays::read_compressed(Stream& stream, std::uint64_t bytes) const {
  if (file_.compressor != kZlib)
    file_.source.unsupported(fmt::format("is compressed by {:.40}", file_.compressor),
                             "write it with vtkZLibDataCompressor or without compression");
  // The number of blocks, the bytes of a block, those of the last if it is not full, and the compressed bytes of each.
  const std::uint64_t size = size_of(file_.header);
  const std::uint64_t count = word(stream.first(size));
  VtkXmlArray result;
  if (count == 0 && bytes == 0) return result;
  if (count == 0 || count > (std::uint64_t{1} << 56))
    stream.malformed("has an impossible number of blocks", {}, fmt::format("{}", count));
  const std::uint64_t head = (count + 3) * size;
  const char* words = stream.first(head);
  const std::uint64_t block = word(words + size);
  const std::uint64_t last = word(words + 2 * size);
  const std::uint64_t full = last == 0 ? count : count - 1;
  if (last > block || (full > 0 && block > bytes / full) || full * block + last != bytes)
    stream.malformed("has another length than its count asks for", fmt::format("{} bytes", bytes),
                     fmt::format("{} blocks of {} and {} bytes", full, block, last));
  std::vector<std::uint64_t> begins(static_cast<std::size_t>(count) + 1, head);
  const std::uint64_t room = file_.source.bytes.size();
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint64_t length = word(words + (i + 3) * size);
    if (length > room || begins[i] + length > head + room)
      stream.malformed("has blocks beyond the end of the file", {}, fmt::format("{} bytes", length));
    begins[i + 1] = begins[i] + length;
  }
  if (bytes > believable_size(begins.back() - head)) stream.too_much();

  const char* packed = stream.first(begins.back());
  result.owned = Bytes(static_cast<std::size_t>(bytes));
  const std::size_t grain = std::max<std::size_t>(1, (std::size_t{1} << 17) / std::max<std::size_t>(1, block));
  parallel_for(static_cast<std::size_t>(count), grain, [&](std::size_t begin, std::size_t end) {
    const Inflater inflater = make_inflater();
    for (std::size_t i = begin; i < end; ++i) {
      const std::uint64_t wanted = i < full ? block : last;
      std::size_t made = 0;
      const libdeflate_result status =
          libdeflate_zlib_decompress(inflater.get(), packed + begins[i], begins[i + 1] - begins[i],
                                     result.owned.data() + i * block, wanted, &made);
      if (status != LIBDEFLATE_SUCCESS || made != wanted)
        stream.malformed(fmt::format("has a damaged block of compressed data, number {}", i),
                         fmt::format("{} bytes", wanted),
                         status == LIBDEFLATE_SUCCESS ? fmt::format("{} bytes", made) : "");
    }
  });
  result.first = result.owned.data();
  return result;
}

}  // namespace meniscus::io
