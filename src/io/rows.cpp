#include "io/rows.h"

namespace meniscus::io {

void read_rows(const RowParts& rows, std::endian order, std::size_t begin, std::size_t end) {
  for (const RowPart& part : rows.parts)
    read_columns(part.type, order, rows.first + begin * rows.stride + part.offset, rows.stride, end - begin,
                 part.components, part.target + begin * part.components);
}

void read_rows(const RowParts& rows, std::endian order, std::size_t count) {
  parallel_for(count, kRowsAtOnce, [&](std::size_t begin, std::size_t end) { read_rows(rows, order, begin, end); });
}

}  // namespace meniscus::io
