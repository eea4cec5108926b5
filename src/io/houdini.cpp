// Points of Houdini's geometry in JSON, as GA_IOJSON writes it: a list of names and values in turn,
//   "pointcount", N, ..., "attributes", ["pointattributes", [[definition, values], ...], ...], "primitives", ...
#include <fmt/format.h>

#include <algorithm>

#include "io/frame_head.h"
#include "io/houdini_values.h"
#include "io/index_texts.h"
#include "io/readers.h"

namespace meniscus::io {

using Kind = HoudiniWord::Kind;

namespace {

constexpr std::size_t kMostAttributes = 65536;

/// What the list tells before any attribute is read.
struct Outline {
  std::uint64_t points = 0;
  std::uint64_t primitives = 0;
  std::optional<HoudiniJson::Place> attributes;  ///< of the points
};

/// Throws where there are more points than a file of `file_bytes` can stand for; `json` may have its start only.
void check_count(const HoudiniJson& json, std::uint64_t points, std::uint64_t file_bytes) {
  constexpr std::uint64_t kPosition = 3 * sizeof(float);
  if (points > most_constant_bytes(file_bytes) / kPosition)
    json.malformed("has an impossible number of points", 0, {}, fmt::format("{}", points));
}

Outline outline_of(HoudiniJson& json) {
  Outline outline;
  std::optional<std::uint64_t> points;
  json.for_each([&](const std::string& name) {
    if (name == "pointcount") {
      points = json.count("the number of points");
    } else if (name == "primitivecount") {
      outline.primitives = json.count("the number of primitives");
    } else if (name == "attributes") {
      json.for_each([&](const std::string& kind) {
        if (kind == "pointattributes") outline.attributes = json.place();
        json.skip();
        return true;
      });
    } else {
      json.skip();
    }
    return true;
  });
  if (!points) json.malformed("does not tell its number of points", json.place().at, "\"pointcount\"");
  outline.points = *points;
  return outline;
}

/// One attribute's name and type: ["scope", "public", "type", "numeric", "name", "P", ...].
struct Definition {
  std::string name;
  std::string type;
};

Definition definition_of(HoudiniJson& json) {
  Definition definition;
  json.for_each([&](const std::string& name) {
    const HoudiniWord value = json.next();
    json.finish(value);
    if (name == "name") definition.name = value.text;
    if (name == "type") definition.type = value.text;
    return true;
  });
  return definition;
}

/// Reads the attributes of the points, one after the other.
class Points {
 public:
  Points(HoudiniJson& json, std::uint64_t count, const ReadOptions& options)
      : json_(json), values_(json, count), options_(options) {
    particles_.format = "houdini";
  }

  /// The list that comes next.
  void read() {
    const HoudiniWord first = json_.next();
    if (first.kind != Kind::begin) json_.malformed("the attributes of the points are missing", first.at, "a list");
    for (std::size_t i = 0; json_.next().kind != Kind::end; ++i) {
      if (i == kMostAttributes)
        json_.malformed("has an impossible number of point attributes", json_.place().at,
                        fmt::format("at most {}", kMostAttributes));
      read_one();
      if (const HoudiniWord last = json_.next(); last.kind != Kind::end)
        json_.malformed("an attribute has more than a definition and values", last.at);
    }
  }

  Particles take() {
    if (!left_out_.empty()) particles_.notes.push_back("left out attributes: " + left_out_);
    return std::move(particles_);
  }
  bool has_positions() const { return has_positions_; }

 private:
  void read_one() {
    const Definition definition = definition_of(json_);
    if (definition.type != "numeric" && definition.type != "string") {
      json_.skip();
      if (left_out_.size() < 200)
        left_out_ += fmt::format("{}'{:.60}' is of type '{:.40}'", left_out_.empty() ? "" : ", ", definition.name,
                                 definition.type);
      return;
    }
    IndexTexts texts;
    json_.for_each([&](const std::string& name) {
      if (name == "values" || name == "indices") {
        take_values(definition.name, values_.read(definition.name));
      } else if (name == "strings") {
        add_texts(texts);
      } else {
        json_.skip();
      }
      return true;
    });
    if (definition.type == "string") particles_.notes.push_back(texts.note(definition.name));
  }

  void add_texts(IndexTexts& texts) {
    const HoudiniWord first = json_.next();
    if (first.kind != Kind::begin) return;  // none may be an array of no numbers
    for (HoudiniWord word = json_.next(); word.kind != Kind::end; word = json_.next()) {
      texts.add(word.text);
      json_.finish(word);
    }
  }

  void take_values(const std::string& name, const HoudiniValues& values) {
    const NumberArray& array = values.array;
    if (name != "P" || has_positions_) {
      particles_.attributes.push_back(attribute_of(array));
      return;
    }
    if (array.columns() < 3)
      json_.malformed("the positions have too few components", json_.place().at, "3 or 4",
                      fmt::format("{}", array.columns()));
    set_positions(*array.type, array.order, {array.column(0), array.column(1), array.column(2)},
                  static_cast<std::size_t>(array.shape[0]), options_, particles_);
    has_positions_ = true;
  }

  HoudiniJson& json_;
  HoudiniValueReader values_;
  const ReadOptions& options_;
  Particles particles_;
  std::string left_out_;
  bool has_positions_ = false;
};

}  // namespace

void look_at_houdini(const Source& start, FrameHead& head) {
  head.format = "houdini";
  HoudiniJson json(start);
  head.text = !start.starts_with("\x7f");
  try {
    json.for_each([&](const std::string& name) {
      head.counted = name == "pointcount";
      if (head.counted) head.particles = json.count("the number of points");
      if (!head.counted) json.skip();
      return !head.counted;
    });
  } catch (const Error&) {
    // Where the number stands behind what is looked at, the size of the file must do.
    if (start.bytes.size() >= head.plain_bytes) throw;
  }
  if (head.particles == 0) return;
  check_count(json, head.particles, head.plain_bytes);
  const double a_particle = static_cast<double>(head.plain_bytes) / static_cast<double>(head.particles);
  head.values = std::max(3.0, a_particle / (head.text ? 9.0 : 4.0));
}

Particles read_houdini(const Source& source, const ReadOptions& options) {
  HoudiniJson json(source);
  const Outline outline = outline_of(json);
  check_count(json, outline.points, source.bytes.size());
  Points points(json, outline.points, options);
  if (outline.attributes) {
    json.seek(*outline.attributes);
    points.read();
  }
  if (!points.has_positions() && outline.points > 0)
    source.malformed("its points have no positions", json.place().at, "a point attribute P");
  Particles particles = points.take();
  note_primitives(outline.primitives, particles);
  return particles;
}

void note_primitives(std::uint64_t count, Particles& particles) {
  if (count > 0) particles.notes.push_back(fmt::format("{} primitives were left out: only the points are read", count));
}

}  // namespace meniscus::io
