#include "io/particle_rows.h"

#include "io/positions.h"
#include "io/unwritten.h"

namespace meniscus::io {

void set_rows(Stored first, std::size_t stride, std::size_t count, std::endian order, std::span<const RowValue> values,
              const ReadOptions& options, Particles& particles) {
  std::vector<RowPart> parts;
  const std::size_t before = particles.attributes.size();
  particles.attributes.resize(before + values.size());
  for (std::size_t i = 0; i < values.size(); ++i) {
    Attribute& attribute = particles.attributes[before + i];
    attribute.name = values[i].name;
    attribute.components = static_cast<int>(values[i].components);
    resize_unwritten(attribute.values, count * values[i].components);
    parts.push_back({values[i].type, values[i].offset, values[i].components, attribute.values.data()});
  }
  constexpr std::size_t kFloat = sizeof(float);
  set_positions(Scalar::float32, order, {Column{first, stride}, {first + kFloat, stride}, {first + 2 * kFloat, stride}},
                count, options, particles, {first, stride, parts});
}

}  // namespace meniscus::io
