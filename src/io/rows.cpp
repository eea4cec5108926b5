#include "io/rows.h"

namespace meniscus::io {

void read_rows(const char* first, std::size_t stride, std::endian order, std::size_t rows,
               std::span<const RowPart> parts) {
  constexpr std::size_t kBlock = 4096;
  parallel_for(rows, kBlock, [&](std::size_t begin, std::size_t end) {
    for (const RowPart& part : parts)
      read_columns(part.type, order, first + begin * stride + part.offset, stride, end - begin, part.components,
                   part.target + begin * part.components);
  });
}

}  // namespace meniscus::io
