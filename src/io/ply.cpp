#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "io/attributes.h"
#include "io/number_arrays.h"
#include "io/ply_header.h"
#include "io/readers.h"
#include "io/text.h"
#include "io/unwritten.h"

namespace meniscus::io {
namespace {

/// A stored 8-bit sRGB value as linear, [0, 1].
float linear_from_byte(float value) {
  const float s = value / 255.0f;
  return s <= 0.04045f ? s / 12.92f : std::pow((s + 0.055f) / 1.055f, 2.4f);
}

class PlyReader {
 public:
  PlyReader(const Source& source, PlyHeader header, const ReadOptions& options)
      : source_(source), header_(std::move(header)), options_(options), text_(source, header_.end), at_(header_.end) {}

  Particles read() {
    particles_.format = "ply";
    particles_.time = header_.time;
    particles_.spacing = header_.spacing;
    particles_.up = header_.up;
    for (const PlyElement& element : header_.elements) {
      if (element.name != "vertex") {
        skip(element);
        continue;
      }
      read_vertices(element);
      if (&element == last_with_rows()) check_end();
      return std::move(particles_);
    }
    source_.malformed("has no element 'vertex'", header_.end, "element vertex");
  }

 private:
  /// The vertices, or an element behind them that has rows.
  const PlyElement* last_with_rows() const {
    const PlyElement* last = nullptr;
    for (const PlyElement& element : header_.elements)
      if (element.name == "vertex" ? last == nullptr || last->name != "vertex"
                                   : element.count > 0 && !element.properties.empty())
        last = &element;
    return last;
  }

  /// Throws if more than blanks follow what was read, in binary files more than one line end.
  void check_end() {
    constexpr std::size_t kLineEnd = 2;
    const std::size_t end = position();
    const std::size_t rest = source_.bytes.size() - end;
    source_.need(end, kLineEnd);
    const auto left = source_.bytes.subspan(end, header_.ascii ? rest : std::min(rest, kLineEnd));
    if ((header_.ascii || rest <= kLineEnd) && std::all_of(left.begin(), left.end(), is_blank)) return;
    source_.require_end(end, "vertices");
  }

  void skip(const PlyElement& element) {
    if (element.properties.empty()) return;
    need_lists(element);
    source_.require(position(), element.count, header_.ascii ? 1 : element.row_size(), element.name + " rows");
    if (!header_.ascii && !element.has_list()) {
      at_ += element.count * element.row_size();
      return;
    }
    for (std::uint64_t row = 0; row < element.count; ++row) {
      for (const PlyProperty& property : element.properties) skip_value(property, element.name);
    }
  }

  /// What is read value by value has to be in memory.
  void need_lists(const PlyElement& element) const {
    if (header_.ascii || element.has_list()) source_.need_all();
  }

  std::size_t position() const { return header_.ascii ? text_.at() : at_; }

  /// Moves over one value or list.
  void skip_value(const PlyProperty& property, std::string_view what) {
    if (header_.ascii) {
      text_.skip_words(property.list_count_type ? text_.count(what) : 1, what);
      return;
    }
    std::uint64_t items = 1;
    if (property.list_count_type) {
      const std::size_t size = size_of(*property.list_count_type);
      source_.require(at_, 1, size, what);
      const double count = read_value(*property.list_count_type, header_.order, source_.bytes.data() + at_);
      if (!(count >= 0 && count <= static_cast<double>(source_.bytes.size()))) {
        source_.malformed("a list has an impossible length", at_, {}, fmt::format("{}", count));
      }
      items = static_cast<std::uint64_t>(count);
      at_ += size;
    }
    source_.require(at_, items, size_of(property.type), what);
    at_ += items * size_of(property.type);
  }

  void read_vertices(const PlyElement& vertex) {
    const std::array<std::size_t, 3> axes = axes_of(vertex);
    need_lists(vertex);
    source_.require(position(), vertex.count, header_.ascii ? 2 * vertex.properties.size() - 1 : vertex.row_size(),
                    "vertices");
    if (header_.ascii || vertex.has_list()) {
      read_one_by_one(vertex, axes);
    } else {
      read_blocks(vertex, axes);
      at_ += vertex.count * vertex.row_size();
    }
    join_colour(vertex);
  }

  /// Which properties are x, y and z: the first of the name.
  std::array<std::size_t, 3> axes_of(const PlyElement& vertex) const {
    std::array<std::size_t, 3> axes{};
    constexpr std::array<std::string_view, 3> kAxes{"x", "y", "z"};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const auto found = std::find_if(
          vertex.properties.begin(), vertex.properties.end(),
          [&](const PlyProperty& property) { return property.name == kAxes[axis] && !property.list_count_type; });
      if (found == vertex.properties.end())
        source_.malformed(fmt::format("its vertices have no property '{}'", kAxes[axis]), header_.end);
      axes[axis] = static_cast<std::size_t>(found - vertex.properties.begin());
    }
    return axes;
  }

  static int axis_of(const std::array<std::size_t, 3>& axes, std::size_t property) {
    const auto found = std::find(axes.begin(), axes.end(), property);
    return found == axes.end() ? -1 : static_cast<int>(found - axes.begin());
  }

  /// Rows whose lengths are known only when they are read: text, and rows with lists.
  void read_one_by_one(const PlyElement& vertex, const std::array<std::size_t, 3>& axes) {
    const auto count = static_cast<std::size_t>(vertex.count);
    std::vector<double> positions(3 * count);
    std::vector<std::vector<float>> columns(vertex.properties.size());
    std::vector<int> axis(columns.size());
    for (std::size_t p = 0; p < columns.size(); ++p) {
      axis[p] = axis_of(axes, p);
      if (!vertex.properties[p].list_count_type && axis[p] < 0) columns[p].resize(count);
    }
    for (std::size_t row = 0; row < vertex.count; ++row) {
      for (std::size_t p = 0; p < columns.size(); ++p) {
        const PlyProperty& property = vertex.properties[p];
        if (property.list_count_type) {
          skip_value(property, "vertices");
        } else if (axis[p] >= 0) {
          positions[3 * row + static_cast<std::size_t>(axis[p])] = value_of(property);
        } else {
          columns[p][row] = header_.ascii ? text_.number("vertices") : static_cast<float>(value_of(property));
        }
      }
    }
    set_positions(positions, options_, particles_);
    for (std::size_t p = 0; p < columns.size(); ++p) {
      const PlyProperty& property = vertex.properties[p];
      if (property.list_count_type) {
        particles_.notes.push_back(fmt::format("property '{}' is a list and was left out", property.name));
      } else if (axis[p] < 0) {
        particles_.attributes.push_back({property.name, 1, std::move(columns[p])});
      }
    }
  }

  double value_of(const PlyProperty& property) {
    if (header_.ascii) return text_.wide_number("vertices");
    const std::size_t before = at_;
    skip_value(property, "vertices");
    return read_value(property.type, header_.order, source_.bytes.data() + before);
  }

  /// Three properties of one type that stand side by side and are the components of a vector: its name.
  static std::optional<std::string> vector_at(const PlyElement& vertex, std::size_t p) {
    if (p + 2 >= vertex.properties.size()) return std::nullopt;
    std::optional<Component> parts[3];
    for (std::size_t c = 0; c < 3; ++c) {
      if (vertex.properties[p + c].type != vertex.properties[p].type) return std::nullopt;
      parts[c] = component_of(vertex.properties[p + c].name);
      if (!parts[c] || parts[c]->index != static_cast<int>(c) || parts[c]->base != parts[0]->base) return std::nullopt;
    }
    return parts[0]->base == "position" ? std::nullopt : std::optional(parts[0]->base);
  }

  /// Rows of one size: converted in blocks.
  void read_blocks(const PlyElement& vertex, const std::array<std::size_t, 3>& axes) {
    const auto count = static_cast<std::size_t>(vertex.count);
    const std::size_t stride = vertex.row_size();
    const Stored first = source_.stored(at_);
    std::vector<std::size_t> offsets;
    std::vector<RowPart> parts;
    std::size_t offset = 0, inside = 0;  // properties to come that belong to a vector which has begun
    for (std::size_t p = 0; p < vertex.properties.size(); ++p) {
      const Scalar type = vertex.properties[p].type;
      offsets.push_back(offset);
      if (inside > 0) {
        --inside;
      } else if (axis_of(axes, p) < 0) {
        const std::optional<std::string> vector = vector_at(vertex, p);
        parts.push_back({type, offset, vector ? 3u : 1u, nullptr});
        particles_.attributes.push_back({vector.value_or(vertex.properties[p].name), vector ? 3 : 1, {}});
        if (vector) inside = 2;
      }
      offset += size_of(type);
    }
    for (std::size_t i = 0; i < parts.size(); ++i) {
      resize_unwritten(particles_.attributes[i].values, count * parts[i].components);
      parts[i].target = particles_.attributes[i].values.data();
    }
    const RowParts rows{first, stride, parts};
    const Scalar type = vertex.properties[axes[0]].type;
    if (std::all_of(axes.begin(), axes.end(), [&](std::size_t p) { return vertex.properties[p].type == type; })) {
      set_positions(type, header_.order,
                    {Column{first + offsets[axes[0]], stride},
                     {first + offsets[axes[1]], stride},
                     {first + offsets[axes[2]], stride}},
                    count, options_, particles_, rows);
      return;
    }
    read_rows(rows, header_.order, count);
    std::array<NumberArray, 3> arrays;
    PositionArrays found{{0, 1, 2}, vertex.count};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      arrays[axis].type = vertex.properties[axes[axis]].type;
      arrays[axis].order = header_.order;
      arrays[axis].shape = {vertex.count};
      arrays[axis].first = first + offsets[axes[axis]];
      arrays[axis].stride = stride;
    }
    set_positions(arrays, found, options_, particles_);
  }

  /// red, green, blue of 8 bits become "color", linear.
  void join_colour(const PlyElement& vertex) {
    std::array<std::size_t, 3> at{};
    constexpr std::array<std::string_view, 3> kNames{"red", "green", "blue"};
    for (std::size_t c = 0; c < 3; ++c) {
      const auto property = std::find_if(vertex.properties.begin(), vertex.properties.end(), [&](const PlyProperty& p) {
        return p.name == kNames[c] && p.type == Scalar::uint8 && !p.list_count_type;
      });
      const auto attribute = std::find_if(particles_.attributes.begin(), particles_.attributes.end(),
                                          [&](const Attribute& a) { return a.name == kNames[c]; });
      if (property == vertex.properties.end() || attribute == particles_.attributes.end()) return;
      at[c] = static_cast<std::size_t>(attribute - particles_.attributes.begin());
    }
    Attribute colour{"color", 3, std::vector<float>(3 * particles_.size())};
    for (std::size_t c = 0; c < 3; ++c) {
      const std::vector<float>& values = particles_.attributes[at[c]].values;
      for (std::size_t i = 0; i < values.size(); ++i) colour.values[3 * i + c] = linear_from_byte(values[i]);
    }
    std::erase_if(particles_.attributes,
                  [&](const Attribute& a) { return std::find(kNames.begin(), kNames.end(), a.name) != kNames.end(); });
    particles_.attributes.push_back(std::move(colour));
  }

  Source source_;
  PlyHeader header_;
  const ReadOptions& options_;
  TextCursor text_;
  std::size_t at_;
  Particles particles_;
};

}  // namespace

Particles read_ply(const Source& source, const ReadOptions& options) {
  return PlyReader(source, read_ply_header(source), options).read();
}

}  // namespace meniscus::io
