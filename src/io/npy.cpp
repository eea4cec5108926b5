#include <fmt/format.h>

#include "io/frame_head.h"
#include "io/npy_arrays.h"
#include "io/readers.h"

namespace meniscus::io {
namespace {

/// Of an array of rows of more than three numbers whose meaning nothing tells, the first three.
void keep_three_columns(NpyArrays& arrays, std::vector<std::string>& notes) {
  if (arrays.arrays.size() != 1) return;
  NumberArray& array = arrays.arrays.front();
  if (!array.rows() || array.shape.size() != 2 || array.columns() <= 3) return;
  notes.push_back(
      fmt::format("took the first 3 of {} columns for positions; left out the others, whose meaning "
                  "nothing tells",
                  array.columns()));
  array.shape[1] = 3;
}

}  // namespace

void look_at_npy(const Source& start, FrameHead& head) {
  const std::optional<NpyHeader> header = npy_header_of(start);
  if (!header) start.malformed("the file ends inside its NumPy header", start.bytes.size());
  head.format = "npy";
  head.particles = header->shape.empty() ? 0 : header->shape[0];
  head.counted = true;
  if (header->items == 0) head.particles = 0;
  if (header->item_size > 0 && header->items > head.plain_bytes / header->item_size)
    start.malformed("the file is shorter than its values", header->first);
  double values = 0;
  for (const NpyField& field : header->fields)
    values += field.type ? static_cast<double>(field.size) / static_cast<double>(size_of(*field.type)) : 0;
  if (head.particles > 0 && header->fields.size() > 1) head.values = std::max(3.0, values);
}

Particles read_npy(const Source& source, const ReadOptions& options) {
  NpyArrays arrays;
  add_npy(source, "array", arrays);
  std::vector<std::string> notes;
  keep_three_columns(arrays, notes);
  Particles particles = particles_of(arrays, options, source.path);
  particles.format = "npy";
  // A lone array without names is what it is taken for.
  const bool is_lone = arrays.arrays.size() == 1 && arrays.arrays[0].name == "array";
  if (is_lone) particles.notes = std::move(notes);
  return particles;
}

}  // namespace meniscus::io
