#include "io/houdini_values.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <numeric>

#include "io/half.h"

namespace meniscus::io {

using Kind = HoudiniWord::Kind;

namespace {

constexpr std::uint64_t kMostComponents = 256;

/// Whether bit `i` of packed ones is set.
bool bit_of(const NumberRun& run, std::endian order, std::uint64_t i) {
  const char* word = run.first + i / 32 * 4;
  return (static_cast<std::uint32_t>(read_value(Scalar::uint32, order, word)) >> (i % 32) & 1) != 0;
}

/// Floats of 16 bits as floats.
Bytes widened(const NumberRun& run, std::endian order) {
  Bytes floats(static_cast<std::size_t>(run.count) * sizeof(float));
  for (std::size_t i = 0; i < run.count; ++i) {
    const float value = float_of_half(static_cast<unsigned>(read_value(run.type, order, run.first + 2 * i)));
    std::memcpy(floats.data() + i * sizeof value, &value, sizeof value);
  }
  return floats;
}

/// Bits as bytes.
Bytes unpacked(const NumberRun& run, std::endian order) {
  Bytes bytes(static_cast<std::size_t>(run.count));
  for (std::size_t i = 0; i < run.count; ++i) bytes.data()[i] = bit_of(run, order, i) ? 1 : 0;
  return bytes;
}

}  // namespace

std::uint64_t most_constant_bytes(std::uint64_t file_bytes) {
  return std::max<std::uint64_t>(std::uint64_t{64} << 20, 32 * file_bytes);
}

/// What the names of a block of values say, and where its numbers stand.
struct HoudiniValueReader::Block {
  enum class Form { none, tuples, arrays, pages };
  Form form = Form::none;
  HoudiniJson::Place place;
  std::size_t at = 0;
  std::uint64_t size = 1;  ///< components
  std::uint64_t page = 0;  ///< elements
  std::vector<std::uint64_t> packing;
  std::vector<std::vector<bool>> constant;  ///< of each packed part, of each page; empty: no page is

  bool has_constant_pages() const {
    return std::any_of(constant.begin(), constant.end(), [](const std::vector<bool>& flags) {
      return std::find(flags.begin(), flags.end(), true) != flags.end();
    });
  }
};

/// Numbers one after the other, whatever lists they stood in.
struct HoudiniValueReader::Flat {
  Scalar type = Scalar::float64;
  std::endian order = std::endian::native;
  const char* first = nullptr;
  std::uint64_t count = 0;
  Bytes owned;
  std::vector<double> parsed;
};

std::vector<std::uint64_t> HoudiniValueReader::packing_of() {
  const Flat flat = flat_of(json_.place(), kMostComponents);
  json_.skip();
  std::vector<std::uint64_t> packing;
  for (std::uint64_t i = 0; i < flat.count; ++i) {
    const double value = read_value(flat.type, flat.order, flat.first + i * size_of(flat.type));
    packing.push_back(value >= 1 && value <= kMostComponents ? static_cast<std::uint64_t>(value) : 0);
  }
  return packing;
}

/// true, false, 0 and 1, or bits.
std::vector<bool> HoudiniValueReader::flags_of() {
  std::vector<bool> flags;
  const HoudiniWord first = json_.next();
  if (first.kind == Kind::run) {
    for (std::uint64_t i = 0; i < first.run.count; ++i)
      flags.push_back(first.run.form == NumberRun::Form::bits
                          ? bit_of(first.run, json_.order(), i)
                          : read_value(first.run.type, json_.order(), first.run.first + i * size_of(first.run.type)) !=
                                0);
    return flags;
  }
  if (first.kind != Kind::begin) json_.malformed("marks of constant pages are missing", first.at, "a list");
  for (HoudiniWord word = json_.next(); word.kind != Kind::end; word = json_.next()) {
    if (word.kind != Kind::truth && word.kind != Kind::number)
      json_.malformed("a mark of a constant page is neither true nor false", word.at);
    flags.push_back(word.number != 0);
  }
  return flags;
}

HoudiniValueReader::Block HoudiniValueReader::block_of() {
  Block block;
  block.at = json_.place().at;
  const auto numbers = [&](Block::Form form) {
    block.form = form;
    block.place = json_.place();
    json_.skip();
  };
  json_.for_each([&](const std::string& name) {
    if (name == "size") {
      block.size = json_.count("the number of components");
    } else if (name == "pagesize") {
      block.page = json_.count("the size of a page");
    } else if (name == "packing") {
      block.packing = packing_of();
    } else if (name == "constantpageflags") {
      const HoudiniWord first = json_.next();
      if (first.kind != Kind::begin && first.kind != Kind::run)
        json_.malformed("marks of constant pages are missing", first.at, "a list of lists");
      if (first.kind == Kind::run) return true;
      for (HoudiniJson::Place place = json_.place(); json_.next().kind != Kind::end; place = json_.place()) {
        json_.seek(place);
        if (block.constant.size() == kMostComponents) json_.malformed("has too many marks of pages", place.at);
        block.constant.push_back(flags_of());
      }
    } else if (name == "tuples") {
      numbers(Block::Form::tuples);
    } else if (name == "arrays") {
      numbers(Block::Form::arrays);
    } else if (name == "rawpagedata") {
      numbers(Block::Form::pages);
    } else {
      json_.skip();
    }
    return true;
  });
  if (block.packing.empty()) block.packing = {block.size};
  return block;
}

HoudiniValueReader::Flat HoudiniValueReader::flat_of(const HoudiniJson::Place& place, std::uint64_t most,
                                                     std::uint64_t inner) {
  const HoudiniJson::Place back = json_.place();
  json_.seek(place);
  const HoudiniWord first = json_.next();
  Flat flat;
  if (first.kind == Kind::run) {
    flat.type = first.run.type;
    flat.order = json_.order();
    flat.first = first.run.first;
    flat.count = first.run.count;
    if (flat.count > most)
      json_.malformed("there are too many numbers", first.at, fmt::format("{}", most), fmt::format("{}", flat.count));
    if (first.run.form != NumberRun::Form::plain) {
      const bool half = first.run.form == NumberRun::Form::half;
      flat.owned = half ? widened(first.run, json_.order()) : unpacked(first.run, json_.order());
      flat.type = half ? Scalar::float32 : Scalar::uint8;
      flat.order = std::endian::native;
      flat.first = flat.owned.data();
    }
  } else if (first.kind == Kind::begin) {
    flat = flat_of_list(most, inner);
  } else {
    json_.malformed("numbers are missing", first.at, "a list of numbers");
  }
  json_.seek(back);
  return flat;
}

/// The numbers of a list that has begun, and of lists in it, which have `inner` each; 0: any number.
HoudiniValueReader::Flat HoudiniValueReader::flat_of_list(std::uint64_t most, std::uint64_t inner) {
  Flat flat;
  std::size_t begin = 0;  // number of the first in the inner list
  const auto check_inner = [&](bool fits, std::size_t at) {
    if (inner > 0 && !fits) json_.malformed("a list has another length than the others", at, fmt::format("{}", inner));
  };
  const auto is_aligned = [&] { return inner > 0 && flat.parsed.size() % inner == 0; };
  for (std::size_t depth = 1; depth > 0;) {
    const HoudiniWord word = json_.next();
    if (word.kind == Kind::begin) {
      ++depth;
      begin = flat.parsed.size();
      check_inner(is_aligned(), word.at);
    } else if (word.kind == Kind::end) {
      check_inner(depth == 1 || flat.parsed.size() - begin == inner, word.at);
      --depth;
    } else if (word.kind == Kind::run && word.run.form == NumberRun::Form::plain) {
      if (word.run.count > most - flat.parsed.size()) json_.malformed("there are too many numbers", word.at);
      check_inner(word.run.count == inner && is_aligned(), word.at);
      for (std::uint64_t i = 0; i < word.run.count; ++i)
        flat.parsed.push_back(read_value(word.run.type, json_.order(), word.run.first + i * size_of(word.run.type)));
    } else if (word.kind == Kind::number || word.kind == Kind::truth) {
      if (flat.parsed.size() == most) json_.malformed("there are too many numbers", word.at, fmt::format("{}", most));
      flat.parsed.push_back(word.number);
    } else {
      json_.malformed("is no number", word.at);
    }
  }
  flat.count = flat.parsed.size();
  flat.first = reinterpret_cast<const char*>(flat.parsed.data());
  return flat;
}

/// Throws unless parts and pages fit the values, and constant pages stand for no more than is believable.
void HoudiniValueReader::check_pages(const Block& block, const std::string& name) {
  const std::uint64_t sum = std::accumulate(block.packing.begin(), block.packing.end(), std::uint64_t{0});
  if (sum != block.size || std::find(block.packing.begin(), block.packing.end(), 0) != block.packing.end())
    json_.malformed(fmt::format("the parts of attribute '{:.60}' are not its components", name), block.at,
                    fmt::format("{}", block.size), fmt::format("{}", sum));
  if (!block.has_constant_pages()) return;
  if (block.page == 0 || block.constant.size() > block.packing.size())
    json_.malformed(fmt::format("the pages of attribute '{:.60}' are damaged", name), block.at);
  const std::uint64_t pages = count_ / block.page + (count_ % block.page > 0 ? 1 : 0);
  for (const std::vector<bool>& flags : block.constant)
    if (!flags.empty() && flags.size() != pages)
      json_.malformed(fmt::format("attribute '{:.60}' has another number of pages than its elements ask for", name),
                      block.at, fmt::format("{}", pages), fmt::format("{}", flags.size()));
  const std::uint64_t most = most_constant_bytes(json_.source().bytes.size());
  if (count_ > most / sizeof(double) / block.size || made_ + count_ * block.size * sizeof(double) > most)
    throw Error(ErrorCode::limit_exceeded,
                {fmt::format("attribute '{:.60}' stands for more values than particles would have", name),
                 {},
                 fmt::format("{} x {}", count_, block.size),
                 json_.source().path,
                 block.at,
                 {},
                 "write the file without constant pages if it is sound"});
  made_ += count_ * block.size * sizeof(double);
}

/// Row after row, from page after page: of each the values of one part after the other, or one value where it is
/// constant.
HoudiniValues HoudiniValueReader::row_by_row(const Block& block, const Flat& flat, const std::string& name) const {
  const std::size_t value = size_of(flat.type), row = static_cast<std::size_t>(block.size) * value;
  HoudiniValues values;
  values.owned = Bytes(static_cast<std::size_t>(count_) * row);
  const std::uint64_t page = block.page > 0 ? std::min(block.page, count_) : count_;
  std::uint64_t taken = 0;
  for (std::uint64_t begin = 0, number = 0; begin < count_; begin += page, ++number) {
    const std::uint64_t rows = std::min(page, count_ - begin);
    std::size_t offset = 0;
    for (std::size_t part = 0; part < block.packing.size(); ++part) {
      const bool constant = part < block.constant.size() && !block.constant[part].empty() &&
                            block.constant[part][static_cast<std::size_t>(number)];
      const std::size_t width = static_cast<std::size_t>(block.packing[part]);
      const std::uint64_t needed = (constant ? 1 : rows) * width;
      if (needed > flat.count - taken)
        json_.malformed(fmt::format("attribute '{:.60}' has too few values", name), block.at);
      const char* from = flat.first + taken * value;
      char* to = values.owned.data() + begin * row + offset;
      for (std::uint64_t i = 0; i < rows; ++i)
        std::memcpy(to + i * row, from + (constant ? 0 : i * width * value), width * value);
      taken += needed;
      offset += width * value;
    }
  }
  if (taken != flat.count)
    json_.malformed(fmt::format("attribute '{:.60}' has too many values", name), block.at, fmt::format("{}", taken),
                    fmt::format("{}", flat.count));
  values.array.first = values.owned.data();
  values.array.stride = row;
  values.array.step = value;
  return values;
}

HoudiniValues HoudiniValueReader::read(const std::string& name) {
  const Block block = block_of();
  if (block.size == 0 || block.size > kMostComponents)
    json_.malformed(fmt::format("attribute '{:.60}' has an impossible number of components", name), block.at,
                    fmt::format("1 to {}", kMostComponents), fmt::format("{}", block.size));
  if (block.form == Block::Form::none)
    json_.source().unsupported(fmt::format("keeps the values of attribute '{:.60}' in an unknown way", name),
                               "export it as classic BGEO version 5");
  const std::uint64_t wanted = count_ * block.size;  // below 2^61: what is counted is below 2^53
  const bool pages = block.form == Block::Form::pages, constant = pages && block.has_constant_pages();
  if (pages) check_pages(block, name);
  const bool by_component = block.form == Block::Form::arrays;
  Flat flat = flat_of(block.place, wanted, pages ? 0 : by_component ? count_ : block.size);
  // Nothing is allocated for what is not there, but for constant pages, which have been checked.
  if (!constant && flat.count != wanted)
    json_.malformed(fmt::format("attribute '{:.60}' has another number of values than its elements ask for", name),
                    block.at, fmt::format("{}", wanted), fmt::format("{}", flat.count));

  HoudiniValues values;
  if (constant || (pages && block.packing.size() > 1)) {
    values = row_by_row(block, flat, name);
  } else {
    const std::size_t value = size_of(flat.type);
    values.array.stride = value * static_cast<std::size_t>(by_component ? 1 : block.size);
    values.array.step = value * static_cast<std::size_t>(by_component ? count_ : 1);
    values.array.first = flat.first;
    values.owned = std::move(flat.owned);
    values.parsed = std::move(flat.parsed);
  }
  values.array.name = name;
  values.array.shape = {count_, block.size};
  values.array.type = flat.type;
  values.array.order = flat.order;
  return values;
}

}  // namespace meniscus::io
