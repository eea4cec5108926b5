#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "io/ply_header.h"
#include "io/readers.h"
#include "io/text.h"

namespace meniscus::io {
namespace {

/// A stored 8-bit sRGB value as linear, [0, 1].
float linear_from_byte(float value) {
  const float s = value / 255.0f;
  return s <= 0.04045f ? s / 12.92f : std::pow((s + 0.055f) / 1.055f, 2.4f);
}

class PlyReader {
 public:
  PlyReader(const Source& source, PlyHeader header)
      : source_(source), header_(std::move(header)), text_(source, header_.end), at_(header_.end) {}

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
      return std::move(particles_);
    }
    source_.malformed("has no element 'vertex'", header_.end, "element vertex");
  }

 private:
  void skip(const PlyElement& element) {
    if (element.properties.empty()) return;
    source_.require(position(), element.count, header_.ascii ? 1 : element.row_size(), element.name + " rows");
    if (!header_.ascii && !element.has_list()) {
      at_ += element.count * element.row_size();
      return;
    }
    for (std::uint64_t row = 0; row < element.count; ++row) {
      for (const PlyProperty& property : element.properties) skip_value(property, element.name);
    }
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
    check_has_position(vertex);
    source_.require(position(), vertex.count, header_.ascii ? 2 * vertex.properties.size() - 1 : vertex.row_size(),
                    "vertices");
    const auto count = static_cast<std::size_t>(vertex.count);
    const std::size_t properties = vertex.properties.size();
    std::vector<std::vector<float>> columns(properties);
    for (std::size_t p = 0; p < properties; ++p) {
      if (!vertex.properties[p].list_count_type) columns[p].resize(count);
    }

    if (header_.ascii) {
      read_ascii(vertex, columns);
    } else if (vertex.has_list()) {
      read_binary_rows(vertex, columns);
    } else {
      // Every row has the same size: convert column by column.
      std::size_t offset = at_;
      for (std::size_t p = 0; p < properties; ++p) {
        const Scalar type = vertex.properties[p].type;
        read_columns(type, header_.order, source_.bytes.data() + offset, vertex.row_size(), count, 1,
                     columns[p].data());
        offset += size_of(type);
      }
    }
    move_columns(vertex, columns);
  }

  void check_has_position(const PlyElement& vertex) const {
    for (const std::string_view axis : {"x", "y", "z"}) {
      const bool found = std::any_of(
          vertex.properties.begin(), vertex.properties.end(),
          [axis](const PlyProperty& property) { return property.name == axis && !property.list_count_type; });
      if (!found) source_.malformed(fmt::format("its vertices have no property '{}'", axis), header_.end);
    }
  }

  void read_ascii(const PlyElement& vertex, std::vector<std::vector<float>>& columns) {
    for (std::size_t row = 0; row < vertex.count; ++row) {
      for (std::size_t p = 0; p < columns.size(); ++p) {
        if (vertex.properties[p].list_count_type) {
          skip_value(vertex.properties[p], "vertices");
        } else {
          columns[p][row] = text_.number("vertices");
        }
      }
    }
  }

  void read_binary_rows(const PlyElement& vertex, std::vector<std::vector<float>>& columns) {
    for (std::size_t row = 0; row < vertex.count; ++row) {
      for (std::size_t p = 0; p < columns.size(); ++p) {
        const PlyProperty& property = vertex.properties[p];
        const std::size_t before = at_;
        skip_value(property, "vertices");
        if (property.list_count_type) continue;
        const double value = read_value(property.type, header_.order, source_.bytes.data() + before);
        columns[p][row] = static_cast<float>(value);
      }
    }
  }

  void move_columns(const PlyElement& vertex, std::vector<std::vector<float>>& columns) {
    bool has_x = false, has_y = false, has_z = false;
    const auto take = [&](const std::string& name, std::string_view axis, bool& taken, std::vector<float>& target,
                          std::vector<float>& column) {
      if (taken || name != axis) return false;
      target = std::move(column);
      return taken = true;
    };
    for (std::size_t p = 0; p < columns.size(); ++p) {
      const PlyProperty& property = vertex.properties[p];
      if (property.list_count_type) {
        particles_.notes.push_back(fmt::format("property '{}' is a list and was left out", property.name));
      } else if (!take(property.name, "x", has_x, particles_.x, columns[p]) &&
                 !take(property.name, "y", has_y, particles_.y, columns[p]) &&
                 !take(property.name, "z", has_z, particles_.z, columns[p])) {
        particles_.attributes.push_back({property.name, 1, std::move(columns[p])});
      }
    }
    join_colour(vertex);
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
  TextCursor text_;
  std::size_t at_;
  Particles particles_;
};

}  // namespace

Particles read_ply(const Source& source, const ReadOptions& /*options*/) {
  return PlyReader(source, read_ply_header(source)).read();
}

}  // namespace meniscus::io
