#include "io/join_pieces.h"

#include <fmt/format.h>

#include <algorithm>

namespace meniscus::io {
namespace {

/// The origin of the piece with the most particles.
glm::dvec3 common_origin(const std::vector<Particles>& pieces) {
  const auto largest = std::max_element(pieces.begin(), pieces.end(),
                                        [](const Particles& a, const Particles& b) { return a.size() < b.size(); });
  return largest != pieces.end() ? largest->origin : glm::dvec3{0.0};
}

const Attribute* find_alike(const Particles& piece, const Attribute& attribute) {
  const Attribute* found = piece.find(attribute.name);
  return found != nullptr && found->components == attribute.components ? found : nullptr;
}

/// Notes of pieces, each once.
void add_notes(const std::vector<std::string>& notes, std::vector<std::string>& all) {
  for (const std::string& note : notes)
    if (std::find(all.begin(), all.end(), note) == all.end()) all.push_back(note);
}

}  // namespace

Particles join_pieces(std::size_t count, const ReadOptions& options,
                      FunctionRef<Particles(std::size_t piece, const ReadOptions&)> read) {
  std::vector<Particles> pieces;
  for (std::size_t i = 0; i < count; ++i) pieces.push_back(read(i, options));
  if (pieces.size() == 1) return std::move(pieces[0]);

  ReadOptions together = options;
  together.origin = common_origin(pieces);
  Particles joined;
  joined.origin = *together.origin;
  std::size_t total = 0;
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    Particles& piece = pieces[i];
    if (!piece.empty() && piece.origin != joined.origin) piece = read(i, together);
    total += piece.size();
    joined.dropped_non_finite += piece.dropped_non_finite;
    joined.format = piece.format;
    if (!joined.time) joined.time = piece.time;
    if (!joined.spacing) joined.spacing = piece.spacing;
    if (!joined.up) joined.up = piece.up;
    add_notes(piece.notes, joined.notes);
  }
  std::erase_if(pieces, [](const Particles& piece) { return piece.empty(); });

  const auto append = [total](std::vector<float>& to, const std::vector<float>& from, std::size_t components) {
    if (to.empty()) to.reserve(total * components);
    to.insert(to.end(), from.begin(), from.end());
  };
  for (Particles& piece : pieces) {
    append(joined.x, piece.x, 1);
    append(joined.y, piece.y, 1);
    append(joined.z, piece.z, 1);
    for (std::vector<float>* done : {&piece.x, &piece.y, &piece.z}) std::vector<float>().swap(*done);
  }
  if (pieces.empty()) return joined;
  for (const Attribute& attribute : pieces[0].attributes) {
    const bool everywhere =
        std::all_of(pieces.begin(), pieces.end(), [&](const Particles& piece) { return find_alike(piece, attribute); });
    if (!everywhere) {
      joined.notes.push_back(fmt::format("array '{}' is not in all pieces and was left out", attribute.name));
      continue;
    }
    Attribute& target = joined.attributes.emplace_back(Attribute{attribute.name, attribute.components, {}});
    for (const Particles& piece : pieces)
      append(target.values, find_alike(piece, attribute)->values, static_cast<std::size_t>(attribute.components));
  }
  return joined;
}

}  // namespace meniscus::io
